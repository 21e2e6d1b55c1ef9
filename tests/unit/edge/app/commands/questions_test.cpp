// `why` and `earned` on a configuration and its log, by the wall clock.
#include <gmock/gmock.h>

#include <ctime>
#include <filesystem>

#include "edge/core/control/policy.h"
#include "edge/records/account/settled_prices.h"
#include "edge/records/log/ring_log.h"
#include "edge/records/log/run_status.h"
#include "edge/records/why/local_moment.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/training_period.h"
#include "tests/support/edge_words.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

class Questions : public ::testing::Test {
 protected:
  Questions() {
    set_market_time_zone();
    config_ = folder_.write("edge.toml", R"(contact = "Ann, +32 2 000 00 00"
[battery]
map = ")" BESS_SOURCE_DIR R"(/edge/device/maps/simulator.toml"
host = "127.0.0.1"
[price]
url = "http://127.0.0.1:1/prices"
)");
    std::filesystem::create_directory(folder_.file("state"));
    FileMessage error;
    EXPECT_TRUE(ring_.open(folder_.file("state/decisions.ring").c_str(), 2'000, error))
        << error.c_str();
  }
  /// At any time of the test: the newest control cycle ends in the quarter-hour of its price,
  /// otherwise its energy has no price yet.
  void end_where_the_price_is() {
    constexpr std::int64_t kQuarterHour = 900;
    until_utc_s_ = until_utc_s_ / kSecondsPerStep * kSecondsPerStep;
    while ((until_utc_s_ - 60) / kQuarterHour !=
           (until_utc_s_ + kSecondsPerStep - 1) / kQuarterHour) {
      until_utc_s_ -= kSecondsPerStep;
    }
  }
  /// `cycles` before now, charging 3 kW at 40 EUR/MWh.
  void log_until_now(int cycles) {
    log_until_now(cycles, [](const CycleRecord&) { return Action::kCharge; });
  }
  /// `decided` by the student.
  template <typename Decided>
  void log_until_now(int cycles, const Decided& decided) {
    newest_utc_s_ = until_utc_s_ / kSecondsPerStep * kSecondsPerStep;
    for (int i = cycles - 1; i >= 0; --i) {
      CycleRecord r{.utc_s = newest_utc_s_ - i * kSecondsPerStep,
                    .cycle = cycles - i,
                    .mode = Mode::kRunning};
      r.has_measurement = true;
      r.measurement.soc_e4 = 5'000;
      r.measurement.power_w = 3'000;
      r.measurement.capacity_wh = 8'000;
      r.price = {.has_row = true, .minute_utc_s = r.utc_s - 60, .price_centi_eur_per_mwh = 4'000};
      r.price_level = PriceLevel::starting_at(9'000);
      r.has_student_action = true;
      r.context_class = 6;
      r.student_action = decided(r);
      r.reason = Reason::kStudent;
      r.ordered_power_w = 3'000;
      r.written = true;
      ASSERT_TRUE(ring_.append(r));
    }
  }
  [[nodiscard]] EdgeOutput ask(std::vector<std::string> words) const {
    words.insert(words.end(), {"--config", config_});
    return run_edge_words(words);
  }

  const TemporaryFolder folder_;
  std::string config_;
  RingLog ring_;
  std::int64_t newest_utc_s_ = 0;
  std::int64_t until_utc_s_ = std::time(nullptr);
};

TEST_F(Questions, WhyAsksForTheNewestCycleOrAnother) {
  log_until_now(30);
  const EdgeOutput newest = ask({"why"});
  EXPECT_EQ(newest.exit_code, 0) << newest.error;
  EXPECT_THAT(newest.out, StartsWith(local_text(newest_utc_s_).c_str()));
  EXPECT_THAT(newest.out, Names("student 30"));
  const std::int64_t before_s = newest_utc_s_ - 20 * kSecondsPerStep;
  for (const std::string& at :
       {std::string(local_clock_text(before_s + 90).view()),
        std::string(local_text(before_s).view()), std::string(utc_text(before_s + 119).view())}) {
    const EdgeOutput then = ask({"why", "--json", "--at", at});
    ASSERT_EQ(then.exit_code, 0) << at << ": " << then.error;
    const Json json = Json::parse(then.out);
    EXPECT_EQ(json.value()["utc"].text(), std::string(utc_text(before_s).view())) << at;
    EXPECT_EQ(json.value()["cycles_with_reason"].number().value(), 10) << at;
  }
}

TEST_F(Questions, WhyRefusesWhatItCannotAnswer) {
  EXPECT_EQ(ask({"why"}).exit_code, 1);
  log_until_now(5);
  const EdgeOutput early = ask({"why", "--at", "2020-01-01 12:00"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.error,
              Names("2020-01-01 12:00 " +
                    std::string(local_text(newest_utc_s_ - 4 * kSecondsPerStep).view())));
  for (const char* at : {"noon", "24:00", "14:60", "2026-02-30 12:00", "12:00 ", "x"}) {
    const EdgeOutput said = ask({"why", "--at", at});
    EXPECT_EQ(said.exit_code, 2) << at;
    EXPECT_THAT(said.error, Names("--at 14:32"));
  }
}

TEST_F(Questions, TheLogIsAskedByTheClockOnTheWall) {
  log_until_now(30);
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  const auto ago = [&](int cycles) {
    return std::string(local_text(newest_utc_s_ - cycles * kSecondsPerStep).view());
  };
  EXPECT_EQ(lines(ask({"log"}).out), 30);
  EXPECT_EQ(lines(ask({"log", "--since", ago(9)}).out), 10);
  EXPECT_EQ(lines(ask({"log", "--since", ago(9), "--until", ago(5)}).out), 5);
  EXPECT_EQ(lines(ask({"log", "--until", ago(5), "--last", "10"}).out), 5);
  EXPECT_EQ(lines(ask({"log", "--since", ago(5), "--until", ago(9)}).out), 0);
  const std::string one = ask({"log", "--at", ago(7), "--local"}).out;
  EXPECT_EQ(lines(one), 1);
  // 3 kW for two minutes, at 40 EUR/MWh.
  EXPECT_THAT(one, AllOf(StartsWith(ago(7)), Names("+100.0 Wh -0.0040 EUR")));
  const std::string csv = ask({"log", "--csv", "--local", "--at", ago(7)}).out;
  EXPECT_THAT(csv, HasSubstr(",local,energy_wh,earned_eur\n"));
  EXPECT_THAT(csv, HasSubstr("," + ago(7) + ",100.00,-0.004000\n"));
  EXPECT_EQ(ask({"log", "--at", "2020-01-01 12:00"}).out, "");
  // The same margins as in `why`, of the same control cycle.
  const Json why = Json::parse(ask({"why", "--at", ago(7), "--json"}).out);
  const auto margin = [&](const char* name) {
    return formatted("%.2f", why.value()["margins"][name].number().value_or(0));
  };
  const std::string charge = margin("charge_up_to_eur_per_mwh");
  const std::string discharge = margin("discharge_from_eur_per_mwh");
  EXPECT_THAT(ask({"log", "--explain", "--at", ago(7)}).out,
              HasSubstr(" charge_up_to=" + charge + " discharge_from=" + discharge + "\n"));
  EXPECT_THAT(ask({"log", "--csv", "--explain", "--at", ago(7)}).out,
              AllOf(HasSubstr(",charge_up_to_eur_per_mwh,discharge_from_eur_per_mwh\n"),
                    HasSubstr("," + charge + "," + discharge + "\n")));
}

TEST_F(Questions, StatusSaysWhomToCall) {
  EXPECT_THAT(ask({"status"}).out, Names("Ann +32 2 000 00 00"));
  const Json status = Json::parse(ask({"status", "--json"}).out);
  EXPECT_STREQ(status.value()["contact"].text(), "Ann, +32 2 000 00 00");
}

/// Status published by the controller. Old training days are a warning and do not affect health.
TEST_F(Questions, StatusShowsTheTrainingDays) {
  const auto published = [&](const char* from, const char* until) {
    RunIdentity identity;
    identity.trained_from = from;
    identity.trained_until = until;
    StoredStatus stored{.status = {.identity = identity}};
    ASSERT_TRUE(write_status(folder_.file("state/status.bin").c_str(), stored));
  };
  const std::string today{local_date_text(std::time(nullptr)).view()};
  published("2023-01-01", today.c_str());
  const EdgeOutput fresh = ask({"status"});
  EXPECT_THAT(fresh.out, Names("2023-01-01 " + today));
  EXPECT_STREQ(Json::parse(ask({"status", "--json"}).out).value()["retrain"].text(), "");
  published("2023-01-01", "2023-05-22");
  const EdgeOutput old = ask({"status"});
  EXPECT_THAT(old.out, Names("2023-05-22 note:"));
  EXPECT_EQ(old.exit_code, fresh.exit_code);
  const Json json = Json::parse(ask({"status", "--json"}).out);
  EXPECT_STREQ(json.value()["trained_from"].text(), "2023-01-01");
  EXPECT_STREQ(json.value()["trained_until"].text(), "2023-05-22");
  EXPECT_STRNE(json.value()["retrain"].text(), "");
  published("", "");
  EXPECT_STREQ(Json::parse(ask({"status", "--json"}).out).value()["retrain"].text(), "");
}

TEST_F(Questions, EarnedAddsTheDaysUp) {
  end_where_the_price_is();
  log_until_now(60);
  const std::string span = std::string(local_text(newest_utc_s_ - 7'200).view()).substr(0, 10) +
                           ".." + std::string(local_text(newest_utc_s_).view()).substr(0, 10);
  const EdgeOutput said = ask({"earned", span, "--json"});
  ASSERT_EQ(said.exit_code, 0) << said.error;
  const Json json = Json::parse(said.out);
  EXPECT_NEAR(json.value()["charged_kwh"].number().value(), 3.0 * 2, 1e-9);
  EXPECT_NEAR(json.value()["earned_eur"].number().value(), -6.0 / 1'000 * 40, 1e-9);
  EXPECT_THAT(ask({"earned", span}).out, Names("-0.24 EUR"));
  EXPECT_THAT(ask({"earned", span, "--csv"}).out, StartsWith("date,earned_eur,"));
  EXPECT_NEAR(json.value()["estimated_eur"].number().value(), -6.0 / 1'000 * 40, 1e-9);
  EXPECT_EQ(json.value()["settled_quarter_hours"].number(), 0);
  EXPECT_EQ(json.value()["stops"]["driven_share"].number(), 1);
}

/// The bill of the log's day, at a price published since.
TEST_F(Questions, EarnedIsBilledByWhatTheNotifierFetched) {
  end_where_the_price_is();
  log_until_now(60);
  const std::string day = std::string(local_text(newest_utc_s_).view()).substr(0, 10);
  SettledPrices prices;
  const SettledQuarter published[] = {{(newest_utc_s_ - 3'600) / 900 * 900, 140}};
  prices.put(published);
  std::filesystem::create_directories(folder_.file("notify"));
  ASSERT_NE(folder_.write("state/settled.csv", prices.text()), "");
  const std::string span = "2020-01-01.." + day;
  const Json json = Json::parse(ask({"earned", span, "--json"}).out);
  // 3 kW at 40 EUR/MWh for two hours, a quarter of an hour of it billed at 140.
  EXPECT_NEAR(json.value()["earned_eur"].number().value_or(0), -0.240 - 0.750 * 0.1, 1e-9);
  EXPECT_EQ(json.value()["settled_quarter_hours"].number(), 1);
  ASSERT_NE(folder_.write("state/settled.csv", "damaged"), "");
  const EdgeOutput damaged = ask({"earned", span});
  EXPECT_EQ(damaged.exit_code, 0);
  EXPECT_THAT(damaged.error, Names("settled.csv"));
}

TEST_F(Questions, EarnedRefusesWhatItCannotAnswer) {
  log_until_now(1);
  const std::string today = std::string(local_text(newest_utc_s_).view()).substr(0, 10);
  const EdgeOutput early = ask({"earned", "2020-01-01..2020-01-31"});
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.error, Names("2020-01-01 2020-01-31 " + today));
  EXPECT_EQ(ask({"earned", "tomorrow"}).exit_code, 2);
  EXPECT_THAT(ask({"earned", "tomorrow"}).error, Names("today yesterday"));
  EXPECT_EQ(ask({"earned", "week", "month"}).exit_code, 2);
  EXPECT_THAT(ask({"earned", "--csv", "--json"}).error, Names("--csv --json"));
}

TEST_F(Questions, AMomentIsTheNewestThatHasBeen) {
  const std::int64_t noon_utc_s = utc_from_local({2026, 11, 23, 12, 0, 0});
  std::int64_t found = 0;
  ASSERT_TRUE(parse_moment("11:59", noon_utc_s, found));
  EXPECT_EQ(found, noon_utc_s - 60);
  ASSERT_TRUE(parse_moment("12:00", noon_utc_s, found));
  EXPECT_EQ(found, noon_utc_s);
  ASSERT_TRUE(parse_moment("12:01", noon_utc_s, found));
  EXPECT_EQ(found, noon_utc_s + 60 - 86'400);
  ASSERT_TRUE(parse_moment("2026-07-01T08:30", noon_utc_s, found));
  EXPECT_EQ(utc_text(found).view(), "2026-07-01T06:30:00Z");
  ASSERT_TRUE(parse_moment("2026-10-25T00:30:00Z", noon_utc_s, found));
  EXPECT_EQ(utc_text(found).view(), "2026-10-25T00:30:00Z");
  // Half past midnight after a day of 23 hours, and late on a day of 25.
  const std::int64_t monday_utc_s = utc_from_local({2026, 3, 30, 0, 30, 0});
  for (const char* text : {"yesterday 14:32", "14:32"}) {
    ASSERT_TRUE(parse_moment(text, monday_utc_s, found));
    EXPECT_EQ(found, utc_from_local({2026, 3, 29, 14, 32, 0})) << text;
  }
  const std::int64_t sunday_utc_s = utc_from_local({2026, 10, 25, 23, 30, 0});
  ASSERT_TRUE(parse_moment("yesterday 14:32", sunday_utc_s, found));
  EXPECT_EQ(found, utc_from_local({2026, 10, 24, 14, 32, 0}));
}

}  // namespace
}  // namespace bess
