// The same days three times: `bess-train log compare` from the log's CSV and the settled prices,
// `bess-sim settle` from the battery's own record, `bess-train evaluate` from the prices alone. A
// month, and three days with a gap, a clock change and restarts, also each day separately. Also the
// same log replayed, and as a statement.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <string>

#include "edge/records/account/day_accounts.h"
#include "shared/host/json.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/hil/real_minutes.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

constexpr double kApart = 0.01;
constexpr double kCapacityMwh = 0.008;
constexpr const char* kNames[] = {"rbc:20:120", "compiled", "foresight"};

/// A day with 30 min without a controller and 12 min without prices; the day of the clock change,
/// with a stop, a kill, and a start before the next tick each; one undisturbed day.
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

/// In EUR, by the names of policies.
struct Judged {
  std::map<std::string, double> paid, at_equal_charge;
};

struct Days {
  std::int32_t first, behind;  ///< as 20230325; the second is no longer one of them
  std::string from, to;
};

/// A run in virtual time, and the results of the three programs.
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
    char line[kLogLineBytes];
    std::string log = std::string(line, format_csv_header(line)) + "\n";
    for (const CycleRecord& cycle : evidence_.log)
      log.append(line, format_csv_line(cycle, line)).append("\n");
    log_ = folder_.write("log.csv", log);
    settled_ = folder_.write("settled.csv", terms_of(prices_).settled.text());
    train_ = folder_.write("train.toml",
                           "[battery]\npower_w = 4000\ncapacity_wh = 8000\n[costs]\n" + costs);
  }

  [[nodiscard]] std::string log_command(const std::string& name, const Days& days,
                                        std::vector<std::string> options) const {
    options.insert(options.begin(),
                   {BESS_TRAIN_PROGRAM, "log", name, log_, "--from", days.from, "--to", days.to});
    const ProgramResult said = run_and_capture(options, 60);
    EXPECT_TRUE(said.is_well()) << said.complaint();
    return said.output;
  }

  [[nodiscard]] Judged compared(const Days& days) const {
    const std::string said = log_command(
        "compare", days,
        {"--config", train_, "--settled", settled_, "--json", "--policy", kNames[0], kNames[1]});
    Judged judged;
    std::string_view rest = said;
    while (!rest.empty()) {
      const Json json = Json::parse(std::string(take_line(rest)));
      const std::string name(json.value()["policy"].text());
      judged.paid[name] = number(json.value()["paid_eur"]);
      judged.at_equal_charge[name] = judged.paid[name] + number(json.value()["charge_eur"]);
    }
    EXPECT_EQ(judged.paid.size(), 4u) << said;
    return judged;
  }

  /// On the same prices, in the minutes that the log covers; the days before give their level.
  [[nodiscard]] Judged evaluated(const Days& days) const {
    write_minute_file(folder_.file("traded.csv"), traded(days), "");
    double soc_frac = -1;
    for (const CycleRecord& r : evidence_.log) {
      const bool is_first =
          soc_frac < 0 && r.has_measurement && local_day_at(r.utc_s) >= days.first;
      if (is_first) soc_frac = r.measurement.soc_e4 / 1e4;
    }
    const ProgramResult said = run_and_capture(
        {BESS_TRAIN_PROGRAM, "evaluate", "--prices", folder_.file("traded.csv"), "--split", "all",
         "--carry-soc", "--config", train_, "--initial-soc", formatted("%.4f", soc_frac), "--json",
         "--policy", kNames[0], kNames[1], kNames[2]},
        60);
    EXPECT_TRUE(said.is_well()) << said.complaint();
    Judged judged;
    std::string_view rest = said.output;
    for (const char* name : kNames) {
      const Json json = Json::parse(std::string(take_line(rest)));
      const double mwh_days = number(json.value()["days"]) * kCapacityMwh;
      const double together = number(json.value()["profit_eur_per_day_per_mwh"]) * mwh_days;
      judged.at_equal_charge[name] = together;
      judged.paid[name] =
          together - number(json.value()["charge_value_eur_per_day_per_mwh"]) * mwh_days;
    }
    return judged;
  }

  [[nodiscard]] double settled_eur(const Days& days) const {
    return settled_by_record(evidence_, prices_, local_day_start_utc_s(days.first),
                             local_day_start_utc_s(days.behind))
        .profit_eur;
  }

  [[nodiscard]] std::string file(const std::string& name) const { return folder_.file(name); }

  static double number(JsonValue value) { return value.number().value_or(std::nan("")); }

 private:
  [[nodiscard]] MinuteSeries traded(const Days& days) const {
    std::set<std::int64_t> minutes;
    for (const CycleRecord& r : evidence_.log) {
      const std::int32_t day = local_day_at(r.utc_s);
      const bool has_price = r.price.has_row && r.utc_s - r.price.minute_utc_s <= 300;
      const bool is_cycle = r.mode != Mode::kStopping && has_price;
      if (is_cycle && day >= days.first && day < days.behind) {
        minutes.insert({r.utc_s, r.utc_s + 60});
      }
    }
    MinuteSeries series = prices_;
    for (std::size_t m = 0; m < series.size(); ++m) {
      if (!minutes.contains(series.utc_s(m))) series.settled[m] = std::nan("");
    }
    return series;
  }

  const TemporaryFolder folder_;
  std::string log_, settled_, train_;
  MinuteSeries prices_;
  Evidence evidence_;
};

void expect_close(double got, double wanted, const std::string& what) {
  std::printf("  %-46s %9.4f %9.4f  %+.3f %%\n", what.c_str(), got, wanted,
              100 * (got / wanted - 1));
  EXPECT_NEAR(got, wanted, kApart * std::fabs(wanted)) << what;
}

void expect_alike(const SameDays& same, const Days& days) {
  const Judged compared = same.compared(days);
  std::printf("%s to %s\n", days.from.c_str(), days.to.c_str());
  expect_close(compared.paid.at("this battery"), same.settled_eur(days), "this battery, settle");
  const Judged judged = same.evaluated(days);
  for (const std::string name : kNames) {
    expect_close(compared.paid.at(name), judged.paid.at(name), name + " paid, evaluate");
    expect_close(compared.at_equal_charge.at(name), judged.at_equal_charge.at(name),
                 name + " with its charge, evaluate");
  }
}

const Days kClockChange{20'230'326, 20'230'327, "2023-03-26", "2023-03-26"};
const Days kAllThree{20'230'325, 20'230'328, "2023-03-25", "2023-03-27"};

TEST(LogCommands, CompareIsThatOfDaysWithAGapAClockChangeAndRestarts) {
  const SameDays days(std::string(kThreeDays) + kRealMinutes + kTheirEvents);
  expect_alike(days, {20'230'325, 20'230'326, "2023-03-25", "2023-03-25"});
  expect_alike(days, kClockChange);
  expect_alike(days, {20'230'327, 20'230'328, "2023-03-27", "2023-03-27"});
  expect_alike(days, kAllThree);
  const Json json = Json::parse(
      days.log_command("replay", kAllThree, {"--student", "compiled", "--json", "--limit", "0"}));
  EXPECT_EQ(json.value()["differing"].number(), 0);
  EXPECT_GT(SameDays::number(json.value()["compared"]), 2'000);
}

}  // namespace
}  // namespace bess
