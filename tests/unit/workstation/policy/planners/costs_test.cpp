// Costs that differ between taking and giving count in all accounting, and a planner with these
// costs does not earn less.
#include <gtest/gtest.h>

#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

constexpr TradingCosts kCosts{.import_adder_eur_per_mwh = 35,
                              .import_percent = 4,
                              .export_fee_eur_per_mwh = 5,
                              .export_percent = 2};

BatteryParameters costly_battery() {
  BatteryParameters battery;
  battery.costs = kCosts;
  battery.wear_eur_per_mwh = 3;
  return battery;
}

/// Fitted with `planned`, run with the real costs.
Evaluation evaluate_planned(const std::string& name, const BatteryParameters& planned) {
  const auto policy = make_baseline(name, small_steps(), planned);
  return evaluate(small_steps(), small_steps().days_of(Split::kTest), *policy,
                  {costly_battery(), 0.5, false});
}

TEST(Costs, PlannersThatKnowThemMoveLessAndEarnAtLeastAsMuch) {
  for (const char* name : {"rbc-tuned", "tabular", "mpc", "sdp", "foresight"}) {
    const Evaluation unaware = evaluate_planned(name, {});
    const Evaluation aware = evaluate_planned(name, costly_battery());
    EXPECT_LT(aware.cycles_per_day(), unaware.cycles_per_day()) << name;
    EXPECT_GE(aware.profit_eur_per_day_per_mwh(), unaware.profit_eur_per_day_per_mwh()) << name;
  }
}

TEST(Costs, NoPolicyEarnsMoreThanForesight) {
  const Evaluation bound = evaluate_planned("foresight", costly_battery());
  for (const char* name : {"rbc-tuned", "sdp"}) {
    for (const BatteryParameters& planned : {BatteryParameters{}, costly_battery()}) {
      const Evaluation e = evaluate_planned(name, planned);
      for (std::size_t d = 0; d < bound.days.size(); ++d) {
        EXPECT_GE(bound.days[d].profit_eur, e.days[d].profit_eur - 0.5) << name << ' ' << d;
      }
    }
  }
}

/// With this spread between taking and giving no exchange of the small market pays.
TEST(Costs, WhereNoSpreadPaysPlannersSellWhatIsThereAndRest) {
  BatteryParameters battery;
  battery.costs.import_adder_eur_per_mwh = 1000;
  const auto days = small_steps().days_of(Split::kTest);
  for (const char* name : {"tabular", "mpc", "sdp", "foresight"}) {
    const auto policy = make_baseline(name, small_steps(), battery);
    std::vector<StepRecord> records;
    evaluate(small_steps(), days, *policy, {battery, 0.5, true}, &records);
    for (const StepRecord& r : records) ASSERT_LE(r.power_w, 0) << name;
  }
}

}  // namespace
}  // namespace bess
