// A log decided again: which cycles differ, by days, and what they are worth, by hand.
#include "edge/account/replay.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "edge/control/policy.h"
#include "edge/log/ring_log.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::int64_t kMidnight = 1'679'698'800;  // 2023-03-24T23:00:00Z, in Brussels

/// Cheap and dear by turns, so that this student charges and discharges; the version before rested.
class RestedBefore : public ::testing::Test {
 protected:
  RestedBefore() {
    set_market_time_zone();
    std::filesystem::create_directory(folder_.file("state"));
    FileMessage error;
    EXPECT_TRUE(ring_.open(folder_.file("state/decisions.ring").c_str(), 2'000, error));
  }
  void log(std::int64_t utc_s, std::int32_t price_eur, bool asked = true,
           std::optional<std::int32_t> level_centi = {}) {
    CycleRecord r{.utc_s = utc_s, .mode = Mode::kRunning, .reason = Reason::kStudent};
    r.has_measurement = true;
    r.measurement.soc_e4 = 5'000;
    r.price = {.has_row = true, .minute_utc_s = utc_s - 60};
    r.price.price_centi_eur_per_mwh = price_eur * 100;
    r.has_student_action = asked;
    r.student_action = Action::kIdle;
    r.context_class = 6;
    if (level_centi) r.price_level = PriceLevel::starting_at(*level_centi);
    ASSERT_TRUE(ring_.append(r));
  }
  Replay replay() {
    EventLogSettings settings;
    settings.ring.assign(folder_.file("state/decisions.ring"));
    LogReader reader;
    FileMessage error;
    EXPECT_TRUE(reader.open(settings, error)) << error.c_str();
    return replay_days(reader, 20'230'325, 20'230'326, 3'000);
  }
  TemporaryFolder folder_;
  RingLog ring_;
};

TEST_F(RestedBefore, WhatItWouldHaveMovedIsWorthItsDistanceFromTheDaysMean) {
  log(kMidnight, -400);
  log(kMidnight + 120, 1'400);
  log(kMidnight + 240, 500, false);  // not asked: not compared, its price is of the day
  log(kMidnight + 86'400, -400);     // alone in its day: at its mean
  const Replay found = replay();
  EXPECT_EQ(found.compared, 3);
  EXPECT_EQ(found.differing, 3);
  ASSERT_EQ(found.days.size(), 2u);
  // 0.1 kWh each: charged at 900 below the mean of 500, discharged at 900 above it.
  EXPECT_NEAR(found.days[0].gained_eur, 0.18, 1e-12);
  EXPECT_NEAR(found.days[1].gained_eur, 0, 1e-12);
  EXPECT_EQ(found.worst_day()->local_day, 20'230'326);
  EXPECT_EQ(found.decisions[1][2], 2);
  EXPECT_EQ(found.decisions[1][0], 1);
  const std::string text = replay_text(found);
  EXPECT_THAT(text, HasSubstr("in 3 of 3 cycles (100.00 %), for about +0.18 EUR\n"));
  EXPECT_THAT(text, HasSubstr("idle      -> charge         2\n"));
  EXPECT_THAT(text, HasSubstr("worst day  2023-03-26: 1 of 1, +0.00 EUR\n"));
  EXPECT_THAT(replayed_cycles_text(found),
              StartsWith("2023-03-25 00:00 local  price -400.00 EUR/MWh, SoC 50.0 %: "
                         "idle -> charge\n2023-03-25 00:02 local "));
  const Json json = Json::parse(replay_json(found).text());
  EXPECT_EQ(json.value()["days"].size(), 2u);
  std::vector<std::string> others;
  for (const JsonValue other : json.value()["others"]) {
    others.push_back(std::string(other["utc"].text_or("")) + " " + other["now"].text_or(""));
  }
  EXPECT_THAT(others, ElementsAre("2023-03-24T23:00:00Z charge", "2023-03-24T23:02:00Z discharge",
                                  "2023-03-25T23:00:00Z charge"));
}

/// Another student's classes may lie elsewhere: what it would have decided is of the level itself.
TEST_F(RestedBefore, ItIsAskedAtTheClassThatTheLevelHasForIt) {
  constexpr std::int32_t kLowCenti = -10'000, kHighCenti = 60'000;
  const LocalMinute then = local_minute_of(kMidnight);
  const auto decides = [&](std::int32_t level_centi, std::int32_t price_eur) {
    return decide_with_student(
        make_lattice_state(then, student_context_class(then, level_centi), 5'000, price_eur * 100));
  };
  std::int32_t price_eur = -100;
  while (decides(kLowCenti, price_eur) == decides(kHighCenti, price_eur) && price_eur < 600) {
    ++price_eur;
  }
  ASSERT_LT(price_eur, 600) << "the shipped student minds the level";
  log(kMidnight, price_eur, true, kLowCenti);
  log(kMidnight + 120, price_eur, true, kHighCenti);
  const Replay found = replay();
  EXPECT_EQ(found.compared, 2);
  std::vector<Action> now(2, Action::kIdle);
  for (const ReplayedCycle& other : found.others) now[other.utc_s == kMidnight ? 0 : 1] = other.now;
  EXPECT_EQ(now[0], decides(kLowCenti, price_eur));
  EXPECT_EQ(now[1], decides(kHighCenti, price_eur));
}

TEST_F(RestedBefore, NothingComparedIsNothing) {
  log(kMidnight, 40, false);
  const Replay none = replay();
  EXPECT_EQ(none.compared, 0);
  EXPECT_EQ(none.differing_share(), 0);
  EXPECT_EQ(none.worst_day(), nullptr);
}

}  // namespace
}  // namespace bess
