// Statement of a month against the battery's own record of energy, and against bess-sim settle: a
// month of real prices in virtual time with the clock change in it, undisturbed, and with a gap,
// restarts and a meter failure.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>

#include "edge/records/account/day_accounts.h"
#include "edge/records/log/ring_log.h"
#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "shared/host/run_program.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/tools/hil/real_minutes.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

constexpr std::int32_t kFirstDay = 20'230'301, kLastDay = 20'230'331;
constexpr double kOfTheMoney = 0.001;

/// From midnight to midnight in Brussels, 31 days less the hour of the clock change; and one
/// control cycle more, which has the power of the last.
constexpr int kMonthMinutes = (31 * 24 - 1) * 60 + 4;

std::string month_of(const std::string& parts) {
  return "title = \"March\"\ntime = \"virtual\"\nstart_utc = \"2023-02-28T23:00:00Z\"\nminutes = " +
         std::to_string(kMonthMinutes) + "\n[prices]\nfile = \"" + kRealMinutes + "\"\n" + parts;
}

/// 6.5 h without a controller, a stop and a kill with a start soon after, 12 h without the meter, a
/// day of a battery that is slow, noisy and slow near its ends.
constexpr const char* kDisturbed = R"([battery]
map = "alphaess"
[house]
seed = 7
[meter]
map = "simulator"
[edge]
meter = "import_w_max = 9000"
[meter_fault]
kinds = ["silence"]
from_min = 10080
to_min = 10800
[battery_fault]
kinds = ["slow-and-noisy", "throttle"]
from_min = 36000
to_min = 37440
[[event]]
at_min = 4000.5
does = "edge_kill"
[[event]]
at_min = 4400
does = "edge_start"
[[event]]
at_min = 20000.5
does = "edge_stop"
[[event]]
at_min = 20003
does = "edge_start"
[[event]]
at_min = 30000.5
does = "edge_kill"
[[event]]
at_min = 30001
does = "edge_start"
)";

/// Each order's power while it was in force; only energy that fits flows. Separately for each
/// direction, where the record has one number per minute.
struct Directions {
  double charged_wh = 0, discharged_wh = 0;
};
Directions by_hand(const Scenario& scenario, const Evidence& evidence) {
  const BatteryParameters& p = scenario.battery.physics;
  Directions sums;
  double soc = scenario.battery.soc_frac;
  for (std::size_t i = 0; i + 1 < evidence.orders.size(); ++i) {
    const DispatchEvent& order = evidence.orders[i];
    const double hours = static_cast<double>(evidence.orders[i + 1].utc_ns - order.utc_ns) / 3.6e12;
    BatteryParameters limited = p;
    limited.soc_min_frac = 0.1;  // comes with the order
    const BatteryStep step = battery_step(limited, soc, order.power_w, hours);
    (step.power_w > 0 ? sums.charged_wh : sums.discharged_wh) += std::fabs(step.power_w) * hours;
    soc = step.soc_frac;
  }
  return sums;
}

struct Month {
  Scenario scenario;
  Outcome outcome;
  MinuteSeries prices;
  MoneyTerms terms;
  Account record;

  [[nodiscard]] std::vector<DayAccount> days() const {
    DayAccounts day_accounts(kFirstDay, kLastDay, terms);
    for (const CycleRecord& cycle : outcome.evidence.log) day_accounts.add(cycle);
    return day_accounts.accounts();
  }
};

Month run_month(const std::string& parts) {
  set_market_time_zone();
  const TemporaryFolder folder;
  Month month{.scenario = read_scenario(folder.write("march.toml", month_of(parts))),
              .outcome = {},
              .prices = read_minute_file(kRealMinutes),
              .terms = {},
              .record = {}};
  month.outcome = run_scenario(month.scenario, true, {});
  EXPECT_TRUE(month.outcome.skipped.empty()) << month.outcome.skipped;
  month.terms = terms_of(month.prices);
  month.record =
      settled_by_record(month.outcome.evidence, month.prices, local_day_start_utc_s(kFirstDay),
                        local_day_start_utc_s(20'230'401));
  return month;
}

/// One process runs all tests of a suite: a map's month is simulated once.
const Month& undisturbed(const std::string& map) {
  static std::map<std::string, Month> months;
  const auto found = months.find(map);
  if (found != months.end()) return found->second;
  return months.emplace(map, run_month("[battery]\nmap = \"" + map + "\"\n")).first->second;
}

/// On maps with a fine SoC, and one that shows whole percents; with and without a known capacity.
TEST(StatementOfAMonth, IsThatOfTheBatterysOwnRecord) {
  for (const std::string map : {"alphaess", "sunspec_124", "huawei_luna2000", "victron_ess3"}) {
    const double apart = map == "victron_ess3" ? 1.5 * kOfTheMoney : kOfTheMoney;
    const Month& month = undisturbed(map);
    EXPECT_TRUE(month.outcome.passed()) << complaint(month.outcome);
    const DayAccount statement = sum_of(month.days());
    const QuarterHourMoney money = statement.exchanged.money;
    EXPECT_NEAR(money.earned_eur, month.record.profit_eur, apart * month.record.profit_eur);
    EXPECT_EQ(money.quarter_hours, 31 * 96 - 4);
    EXPECT_EQ(money.published, money.quarter_hours);
    EXPECT_EQ(money.unpriced, 0);
    EXPECT_EQ(statement.unseen_kwh(), 0);
  }
}

TEST(StatementOfAMonth, CountsBothDirections) {
  const Month& month = undisturbed("alphaess");
  const DayAccount statement = sum_of(month.days());
  const Directions hand = by_hand(month.scenario, month.outcome.evidence);
  EXPECT_NEAR(statement.charged_kwh(), hand.charged_wh / 1'000, hand.charged_wh / 1e6);
  EXPECT_NEAR(statement.discharged_kwh(), hand.discharged_wh / 1'000, hand.discharged_wh / 1e6);
}

TEST(StatementOfAMonth, WithAGapRestartsAMeterCutAndAClockChange) {
  const Month month = run_month(kDisturbed);
  const std::vector<DayAccount> days = month.days();
  const DayAccount statement = sum_of(days);
  EXPECT_NEAR(statement.exchanged.money.earned_eur, month.record.profit_eur,
              kOfTheMoney * month.record.profit_eur);
  EXPECT_GT(statement.unseen_kwh(), 0);
  EXPECT_LT(statement.unseen_kwh(), 2);
  EXPECT_EQ(days.size(), 31u);
}

}  // namespace
}  // namespace bess
