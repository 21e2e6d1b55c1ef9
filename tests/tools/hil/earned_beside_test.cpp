// The same days three times: `bess-edge earned --beside` from the log and the settled prices,
// `bess-sim settle` from the battery's own record, `bess-train evaluate` from the prices alone. A
// month, and three days with a gap, a clock change and restarts, each day by itself as well.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "edge/account/account_days.h"
#include "edge/account/period.h"
#include "edge/log/ring_log.h"
#include "shared/host/json.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/hil/real_minutes.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

constexpr double kApart = 0.01;
constexpr double kCapacityMwh = 0.008;
constexpr const char* kNames[] = {"rule_eur", "student_undisturbed_eur", "foresight_eur"};

/// A day without a controller for half an hour and without prices for twelve minutes; the day of
/// the clock change, with a stop, a kill, and a start before the next tick each; one with none of
/// it.
constexpr const char* kThreeDays = R"(title = "Three days"
time = "virtual"
start_utc = "2023-03-24T23:00:00Z"
minutes = 4264
[battery]
map = "alphaess"
[prices]
missing = [[600, 612]]
file = ")";
constexpr const char* kTheirEvents = R"("
[[event]]
at_min = 360.5
does = "edge_kill"
[[event]]
at_min = 394
does = "edge_start"
[[event]]
at_min = 2000.5
does = "edge_stop"
[[event]]
at_min = 2001
does = "edge_start"
[[event]]
at_min = 2400.5
does = "edge_kill"
[[event]]
at_min = 2401
does = "edge_start"
)";

constexpr const char* kMonth = R"(title = "March"
time = "virtual"
start_utc = "2023-02-28T23:00:00Z"
minutes = 44584
[battery]
map = "alphaess"
[prices]
file = ")";

/// In EUR; by the names that `earned` gives them.
struct Judged {
  std::map<std::string, double> paid, at_equal_charge;
};

/// A run in virtual time, and what the three programs make of it.
class SameDays {
 public:
  explicit SameDays(const std::string& scenario, const std::string& costs = "")
      : folder_("/dev/shm") {  // a record waits for its disk
    set_market_time_zone();
    prices_ = read_minute_file(kRealMinutes);
    Outcome outcome = run_scenario(read_scenario(folder_.write("days.toml", scenario)), true, {});
    EXPECT_TRUE(outcome.skipped.empty()) << outcome.skipped;
    EXPECT_TRUE(outcome.passed()) << complaint(outcome);
    evidence_ = std::move(outcome.evidence);
    RingLog ring;
    FileMessage error;
    std::filesystem::create_directories(folder_.file("state"));
    std::filesystem::create_directories(folder_.file("notify"));
    EXPECT_TRUE(ring.open(folder_.file("state/decisions.ring").c_str(), 35 * 720, error));
    for (const CycleRecord& cycle : evidence_.log) EXPECT_TRUE(ring.append(cycle));
    EXPECT_NE(folder_.write("state/settled.csv", terms_of(prices_).settled.text()), "");
    config_ =
        folder_.write("edge.toml", "[battery]\nmap = \"" BESS_SOURCE_DIR
                                   "/edge/maps/alphaess.toml\"\n"
                                   "host = \"127.0.0.1\"\n[price]\nurl = \"http://127.0.0.1/\"\n"
                                   "[contract]\n" +
                                       costs);
    train_ = folder_.write("train.toml", "[costs]\n" + costs);
  }

  [[nodiscard]] Json earned(const std::string& period) const {
    const ProgramResult said = run_and_hear(
        {BESS_EDGE_PROGRAM, "earned", period, "--beside", "--json", "--config", config_}, 60);
    EXPECT_TRUE(said.is_well()) << said.complaint();
    return Json::parse(said.output);
  }

  /// On the same prices, in the minutes in which the log has one; the days before give their level.
  [[nodiscard]] Judged evaluated(const std::string& period, const Json& earned) const {
    Period days;
    EXPECT_TRUE(parse_period(period, 20'230'401, days));
    write_minute_file(folder_.file("traded.csv"), traded(days), "");
    const JsonValue beside = earned.value()["beside"];
    const std::string rule =
        formatted("rbc:%.2f:%.2f", number(beside["rule"]["charge_below_eur_per_mwh"]),
                  number(beside["rule"]["discharge_above_eur_per_mwh"]));
    double soc_percent = 0;
    for (const JsonValue day : earned.value()["days"]) {
      if (soc_percent == 0) soc_percent = number(day["first_soc_percent"]);
    }
    const ProgramResult said = run_and_hear(
        {BESS_TRAIN_PROGRAM, "evaluate", "--prices", folder_.file("traded.csv"), "--split", "all",
         "--carry-soc", "--config", train_, "--initial-soc", formatted("%.4f", soc_percent / 100),
         "--json", "--policy", rule, "compiled", "foresight"},
        60);
    EXPECT_TRUE(said.is_well()) << said.complaint();
    Judged judged;
    std::string_view rest = said.output;
    for (const char* name : kNames) {
      const Json json = Json::parse(std::string(take_line(rest)));
      const double mwh_days = number(json.value()["days"]) * kCapacityMwh;
      EXPECT_EQ(number(json.value()["days"]), earned.value()["days"].size());
      const double together = number(json.value()["profit_eur_per_day_per_mwh"]) * mwh_days;
      judged.at_equal_charge[name] = together;
      judged.paid[name] =
          together - number(json.value()["charge_value_eur_per_day_per_mwh"]) * mwh_days;
    }
    return judged;
  }

  [[nodiscard]] double settled_eur(const std::string& period) const {
    Period days;
    EXPECT_TRUE(parse_period(period, 20'230'401, days));
    return settled_by_record(evidence_, prices_, start_of(days.first_day),
                             start_of(day_after(days.last_day, 1)))
        .profit_eur;
  }

  static double number(JsonValue value) { return value.number().value_or(std::nan("")); }

 private:
  static std::int64_t start_of(std::int32_t day) { return DayAccount(day).start_utc_s(); }

  [[nodiscard]] MinuteSeries traded(const Period& days) const {
    std::set<std::int64_t> minutes;
    for (const CycleRecord& r : evidence_.log) {
      const std::int32_t day = local_day_at(r.utc_s);
      const bool has_price = r.price.has_row && r.utc_s - r.price.minute_utc_s <= 300;
      const bool is_cycle = r.mode != Mode::kStopping && has_price;
      if (is_cycle && day >= days.first_day && day <= days.last_day)
        minutes.insert({r.utc_s, r.utc_s + 60});
    }
    MinuteSeries series = prices_;
    for (std::size_t m = 0; m < series.size(); ++m) {
      if (!minutes.contains(series.utc_s(m))) series.settled[m] = std::nan("");
    }
    return series;
  }

  const TemporaryFolder folder_;
  std::string config_, train_;
  MinuteSeries prices_;
  Evidence evidence_;
};

void expect_close(double got, double wanted, const std::string& what) {
  std::printf("  %-46s %9.4f %9.4f  %+.3f %%\n", what.c_str(), got, wanted,
              100 * (got / wanted - 1));
  EXPECT_NEAR(got, wanted, kApart * std::fabs(wanted)) << what;
}

void expect_alike(const SameDays& same, const std::string& period) {
  const Json earned = same.earned(period);
  const JsonValue beside = earned.value()["beside"];
  std::printf("%s\n", period.c_str());
  expect_close(SameDays::number(beside["paid"]["this_battery_eur"]), same.settled_eur(period),
               "this battery, settle");
  const Judged judged = same.evaluated(period, earned);
  for (const char* name : kNames) {
    expect_close(SameDays::number(beside["paid"][name]), judged.paid.at(name),
                 std::string(name) + " paid, evaluate");
    const double together = SameDays::number(beside[name]);
    const double wanted = judged.at_equal_charge.at(name);
    if (std::string(name) != "foresight_eur") {
      expect_close(together, wanted, std::string(name) + " with its charge, evaluate");
    } else {  // evaluate plans an end that is free, and counts the charge then: no bound of this
      EXPECT_GE(together, wanted * (1 - kApart)) << period;
    }
  }
  EXPECT_EQ(beside["student_decided_otherwise"].number(), 0) << period;
}

TEST(EarnedBeside, IsWhatSettleAndEvaluateSayOfAMonth) {
  const SameDays month(std::string(kMonth) + kRealMinutes + "\"\n");
  expect_alike(month, "2023-03");
  const Json earned = month.earned("2023-03");
  EXPECT_EQ(earned.value()["beside"]["rule"]["days_before"].number(), 0);
  EXPECT_GT(SameDays::number(earned.value()["beside"]["error_of_difference"]["rule_eur"]), 0);
  // Its last days have the ones before.
  EXPECT_GE(SameDays::number(
                month.earned("2023-03-26..2023-03-31").value()["beside"]["rule"]["days_before"]),
            24);
  expect_alike(month, "2023-03-26..2023-03-31");
}

TEST(EarnedBeside, IsThatOfDaysWithAGapAClockChangeAndRestarts) {
  const SameDays days(std::string(kThreeDays) + kRealMinutes + kTheirEvents);
  for (const char* period : {"2023-03-25", "2023-03-26", "2023-03-27", "2023-03-25..2023-03-27"}) {
    expect_alike(days, period);
  }
}

/// With a contract that lets none of them trade as before.
TEST(EarnedBeside, TakesTheContractFromAllAlike) {
  const SameDays days(std::string(kThreeDays) + kRealMinutes + kTheirEvents,
                      "import_adder_eur_per_mwh = 20\nexport_fee_eur_per_mwh = 3\n"
                      "export_percent = 4\n");
  const Json earned = days.earned("2023-03-26");
  const Judged judged = days.evaluated("2023-03-26", earned);
  for (const char* name : kNames) {
    expect_close(SameDays::number(earned.value()["beside"]["paid"][name]), judged.paid.at(name),
                 std::string(name) + " less the contract");
  }
  EXPECT_LT(judged.paid.at("foresight_eur"), 6.5);  // of 7.24
}

}  // namespace
}  // namespace bess
