// A run with a policy's decisions, step for step, settles at the earnings of evaluate: costs and
// wear are counted equally on both sides of the project.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "shared/utc_text.h"
#include "tests/support/small_market.h"
#include "tools/simulators/settle/settlement.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/policy.h"

namespace bess {
namespace {

TEST(Settlement, WithCostsIsWhatEvaluateSays) {
  const MinuteSeries series = small_series();
  const MarketSteps market = make_market_steps(series, {});
  BatteryParameters battery;
  battery.wear_eur_per_mwh = 4;
  battery.costs = {.import_adder_eur_per_mwh = 45, .export_fee_eur_per_mwh = 3};
  for (const double percent : {0.0, 5.0}) {
    battery.costs.import_percent = battery.costs.export_percent = percent;
    RuleBasedPolicy rule(60, 140);
    std::vector<StepRecord> steps;
    const Evaluation evaluated =
        evaluate(market, {market.days[12]}, rule, {battery, 0.5, false}, &steps);
    std::string log = "utc,mode,soc_e4,ordered_power_w,written,decision_us,write_us,total_us\n";
    std::string record = "minute_utc,energy_wh,soc\n";
    double across_zero_eur = 0;  // a price that changes its sign inside a step
    for (const StepRecord& step : steps) {
      log += fmt::format("{},running,{:.17g},{:.17g},1,5,5,5\n", utc_text(step.utc_s).view(),
                         step.soc_frac * 1e4, power_sign(step.action) * battery.power_w_max);
      double size_eur_per_mwh = 0;
      for (int m = 0; m < 2; ++m) {
        const std::int64_t utc_s = step.utc_s + 60 * m;
        record += fmt::format("{},{:.17g},0.5\n", utc_text(utc_s).view(), step.power_w / 60);
        const auto minute = static_cast<std::size_t>((utc_s - series.start_utc_s) / 60);
        size_eur_per_mwh += std::fabs(series.settled[minute]) / 2;
      }
      across_zero_eur += std::fabs(step.power_w) / 1e6 / 30 * percent / 100 *
                         (size_eur_per_mwh - std::fabs(step.paid_eur_per_mwh));
    }
    const RunSettlement settled =
        settle(CsvTable(record, "record"), CsvTable(log, "log"), series, battery);
    const double profit_eur = evaluated.days[0].profit_eur - across_zero_eur;
    EXPECT_GT(evaluated.days[0].throughput_mwh, 5);
    EXPECT_NEAR(settled.battery.profit_eur, profit_eur, 1e-6);
    EXPECT_NEAR(settled.edge.profit_eur, profit_eur, 1e-6);
    EXPECT_LT(across_zero_eur, 0.001 * std::fabs(profit_eur));
  }
}

}  // namespace
}  // namespace bess
