// Explanations from a log: decider, start, end condition, and the margins in words and as JSON.
#include "edge/records/why/explanation.h"

#include <gmock/gmock.h>

#include <vector>

#include "edge/core/control/policy.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::ElementsAre;

constexpr std::int64_t kTick = 1'763'901'120;  // 2025-11-23T12:32:00Z, 13:32 in Brussels

/// Decision of the built-in student at noon at this price, as the loop would log it.
CycleRecord decided(std::int64_t cycle, std::int32_t price_centi) {
  CycleRecord r{.utc_s = kTick + cycle * kSecondsPerStep, .cycle = cycle, .mode = Mode::kRunning};
  r.has_measurement = true;
  r.measurement.soc_e4 = 4'730;
  r.price = {.has_row = true, .minute_utc_s = r.utc_s - 60, .price_centi_eur_per_mwh = price_centi};
  r.price_age_s = 2;
  r.price_level = PriceLevel::starting_at(8'231);
  const LocalMinute now = local_minute_of(r.utc_s);
  r.context_class = student_context_class(now, context_centi_of(r));
  r.student_action =
      decide_with_student(make_lattice_state(now, r.context_class, 4'730, price_centi));
  r.has_student_action = true;
  r.reason = Reason::kStudent;
  r.ordered_power_w = power_sign(r.student_action) * 4'000;
  return r;
}

class Why : public ::testing::Test {
 protected:
  Why() {
    set_market_time_zone();
    paths_.ring = folder_.file("log.ring").c_str();
    EXPECT_TRUE(ring_.open(paths_.ring.c_str(), 100, error_)) << error_.c_str();
  }
  void log(const CycleRecord& record) { ASSERT_TRUE(ring_.append(record)); }
  Explanation explained(std::uint64_t number = 0) {
    EXPECT_TRUE(reader_.open(paths_, error_)) << error_.c_str();
    Explanation explanation;
    EXPECT_TRUE(explain(reader_, number == 0 ? reader_.newest_number() : number,
                        settings_.guard.thresholds, explanation));
    return explanation;
  }

  const TemporaryFolder folder_;
  EventLogSettings paths_;
  ControlSettings settings_;
  RingLog ring_;
  LogReader reader_;
  FileMessage error_;
};

TEST_F(Why, TheStudentsOrderWithItsMargins) {
  log(decided(0, 1'000));
  const Explanation explanation = explained();
  const std::string text = explanation_text(explanation, settings_);
  ASSERT_EQ(explanation.record.student_action, Action::kCharge) << "at 10 EUR/MWh";
  EXPECT_THAT(text,
              Names("2025-11-23 13:32 0 4000 W student 10.00 EUR/MWh 47.3 % 82.31 -500 1500"));
  EXPECT_FALSE(explanation.is_other_student);
}

TEST_F(Why, EachNumberOfTheMarginsIsInTextAndJson) {
  for (const std::int32_t price_centi : {-60'000, -50'000, -100, 5'000, 12'345, 90'000, 160'000}) {
    log(decided(0, price_centi));
    const Explanation explanation = explained();
    const std::string text = explanation_text(explanation, settings_);
    const Json json = Json::parse(explanation_json(explanation, settings_).text());
    const JsonValue margins = json.value()["margins"];
    for (const JsonValue margin : margins) {
      if (margin.is_null()) continue;
      char number[32];
      std::snprintf(number, sizeof number, "%.2f", margin.number().value());
      EXPECT_THAT(text, ::testing::HasSubstr(number)) << margin.key();
    }
    EXPECT_EQ(margins.size(), 4u);
    EXPECT_DOUBLE_EQ(json.value()["price_eur_per_mwh"].number().value(), price_centi / 100.0);
  }
}

TEST_F(Why, SinceWhenIsTheBeginningOfTheRun) {
  for (int cycle = 0; cycle < 10; ++cycle) {
    CycleRecord r = decided(cycle, 5'000);
    if (cycle >= 4) r.reason = Reason::kSocEmpty;
    log(r);
  }
  EXPECT_EQ(explained().cycles, 6);
  EXPECT_EQ(explained().since_utc_s, kTick + 4 * kSecondsPerStep);
  EXPECT_EQ(explained(4).cycles, 4);
  EXPECT_EQ(explained(7).cycles, 3) << "later records do not count";
}

TEST_F(Why, AGapInTheLogStartsAgain) {
  log(decided(0, 5'000));
  log(decided(3, 5'000));
  log(decided(5, 5'000));  // a single skipped control cycle is no gap
  EXPECT_EQ(explained().cycles, 2);
}

TEST_F(Why, WhatTheGuardForbidsSaysWhatEndsIt) {
  CycleRecord r = decided(0, 90'000);
  ASSERT_EQ(r.student_action, Action::kDischarge);
  r.reason = Reason::kSocEmpty;
  r.ordered_power_w = 0;
  log(r);
  EXPECT_THAT(explanation_text(explained(), settings_), Names("0 W soc_empty 10.5 % student"));
}

TEST_F(Why, EveryReasonButTheStudentsHasAnEnd) {
  for (int i = 0; i < kReasonCount; ++i) {
    CycleRecord r = decided(i, 5'000);
    r.reason = static_cast<Reason>(i);
    const std::string end = what_ends(r, settings_);
    EXPECT_EQ(end.empty(), r.reason == Reason::kStudent) << reason_name(r.reason);
    EXPECT_EQ(end.find_first_of("{}"), end.npos) << "an unknown value: " << end;
  }
}

TEST_F(Why, ATripHoldsUntilItIsCleared) {
  CycleRecord r = decided(0, 5'000);
  r.reason = Reason::kSocMismatch;
  r.mode = Mode::kSafe;
  r.is_tripped = true;
  r.trip = {.reason = Reason::kSocMismatch, .utc_s = kTick - 600};
  log(r);
  const std::string text = explanation_text(explained(), settings_);
  EXPECT_THAT(text, Names("safe soc_mismatch 2025-11-23 13:22"));
}

TEST_F(Why, ATripShowsWhatWasJudged) {
  for (std::int64_t cycle = 0; cycle < 8; ++cycle) {
    CycleRecord r = decided(cycle, 1'000);
    // The order of the record comes after its reading, which followed the order before, or a cut.
    r.followed = {.is_judged = true, .power_w = 4'000 - static_cast<std::int32_t>(cycle)};
    r.measurement.power_w = -100 - static_cast<std::int32_t>(cycle);
    r.has_measurement = cycle != 4;
    r.is_tripped = cycle >= 5;
    if (r.is_tripped) r.trip = {.reason = Reason::kWrongDirection, .utc_s = kTick + 5 * 120};
    log(r);
  }
  const Explanation explanation = explained();
  const Json json = Json::parse(explanation_json(explanation, settings_).text());
  std::vector<double> ordered_w, measured_w;
  for (const JsonValue cycle : json.value()["evidence"]) {
    ordered_w.push_back(cycle["ordered_power_w"].number().value());
    measured_w.push_back(cycle["measured_power_w"].number().value());
  }
  EXPECT_THAT(ordered_w, ElementsAre(3'998, 3'997, 3'995))
      << "to the trip; one cycle has no reading";
  EXPECT_THAT(measured_w, ElementsAre(-102, -103, -105));
  EXPECT_THAT(explanation_text(explanation, settings_), Names("3998 -102 3997 -103 3995 -105"));
  EXPECT_THAT(explained(4).evidence, ::testing::IsEmpty()) << "before the trip";
}

TEST_F(Why, WithoutAPriceNothingIsInvented) {
  CycleRecord r{.utc_s = kTick, .mode = Mode::kHolding, .reason = Reason::kNoPrice};
  log(r);
  const Explanation explanation = explained();
  EXPECT_FALSE(explanation.has_margins);
  EXPECT_THAT(explanation_text(explanation, settings_),
              ::testing::AllOf(Names("holding no_price"),
                               ::testing::Not(::testing::ContainsRegex("[0-9][.][0-9]+ EUR/MWh"))));
  const Json json = explanation_json(explanation, settings_);
  EXPECT_TRUE(json.value()["margins"].is_null());
  EXPECT_TRUE(json.value()["price_eur_per_mwh"].is_null());
}

TEST_F(Why, AnotherVersionsDecisionIsSaid) {
  CycleRecord r = decided(0, 1'000);
  r.student_action = Action::kDischarge;
  log(r);
  EXPECT_TRUE(explained().is_other_student);
}

TEST_F(Why, TheCycleOfAnInstant) {
  for (const int cycle : {0, 1, 4}) log(decided(cycle, 5'000));
  ASSERT_TRUE(reader_.open(paths_, error_));
  EXPECT_EQ(number_at(reader_, kTick), 1u);
  EXPECT_EQ(number_at(reader_, kTick + 119), 1u);
  EXPECT_EQ(number_at(reader_, kTick + 120), 2u);
  EXPECT_EQ(number_at(reader_, kTick + 2 * 120), 0u) << "nothing was decided then";
  EXPECT_EQ(number_at(reader_, kTick - 1), 0u);
  EXPECT_EQ(number_at(reader_, kTick + 5 * 120), 0u) << "nothing has been decided yet";
}

}  // namespace
}  // namespace bess
