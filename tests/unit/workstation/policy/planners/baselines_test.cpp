// Baselines against their definitions: thresholds as given, tuned ones best where they were tuned,
// foresight above all, and the fast sweep equal to the plain one.
#include <gtest/gtest.h>

#include <set>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/carried_over.h"
#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

double profit(const std::string& name, Split split, bool carry_soc) {
  const auto policy = make_baseline(name, small_steps(), {});
  const auto days = small_steps().days_of(split);
  return evaluate(small_steps(), days, *policy, {.battery = {}, .carry_soc = carry_soc})
      .profit_eur_per_day_per_mwh();
}

TEST(GivenRule, TakesItsThresholdsFromTheName) {
  EXPECT_EQ(profit("rbc:11:179", Split::kTest, false), profit("rbc", Split::kTest, false));
  EXPECT_NO_THROW(make_baseline("rbc:-50.5:80", small_steps(), {}));
  for (const char* bad :
       {"rbc:", "rbc:1", "rbc:1:", "rbc:a:b", "rbc:2:1", "rbc:1:2x", "rbc:1:nan"}) {
    EXPECT_THROW(make_baseline(bad, small_steps(), {}), UserError) << bad;
  }
}

TEST(Baselines, ShownOnesHaveDistinctColoursOfTheStyleSheet) {
  const std::string style = read_file(BESS_SOURCE_DIR "/workstation/report/page/report.css") +
                            read_file(BESS_SOURCE_DIR "/shared/host/embed/document.css");
  std::set<std::string> colours;
  for (const Baseline& row : baselines()) {
    if (row.meaning.empty()) continue;
    EXPECT_TRUE(colours.insert(row.colour).second) << row.name << ": " << row.colour;
    const std::string variable = "--" + row.colour + ":";
    const std::size_t light = style.find(variable);
    ASSERT_NE(light, style.npos) << row.name << ": " << variable;
    EXPECT_NE(style.find(variable, light + 1), style.npos) << row.name << ": dark " << variable;
  }
}

TEST(TunedRule, IsBestOnItsTrainingDaysAndDeterministic) {
  const double tuned = profit("rbc-tuned", Split::kTrain, true);
  for (double low = -50; low <= 150; low += 20) {
    for (double high = low; high <= 250; high += 20) {
      const auto name = "rbc:" + std::to_string(low) + ":" + std::to_string(high);
      EXPECT_GE(tuned, 0.995 * profit(name, Split::kTrain, true)) << name;
    }
  }
  const auto days = small_steps().days_of(Split::kTrain);
  const RuleThresholds a = tune_rule(small_steps(), days, {});
  const RuleThresholds b = tune_rule(small_steps(), days, {});
  EXPECT_EQ(a.low_eur_per_mwh, b.low_eur_per_mwh);
  EXPECT_EQ(a.high_eur_per_mwh, b.high_eur_per_mwh);
}

TEST(Foresight, CarriedOverIsThePlanOfTheWholeSeries) {
  ForesightPolicy foresight({});
  const Evaluation all = evaluate(small_steps(), small_steps().days, foresight, kCarriedOver);
  const auto days = small_steps().days_of(Split::kTest);
  const Evaluation test = evaluate(small_steps(), days, foresight, kCarriedOver);
  ASSERT_EQ(test.days.size(), days.size());
  for (const DayResult& day : test.days) {
    const auto same = std::ranges::find(all.days, day.date, &DayResult::date);
    ASSERT_NE(same, all.days.end());
    EXPECT_EQ(day.profit_eur, same->profit_eur);
  }
  // Over all days it is a bound on every chained policy.
  for (const char* name : {"tabular", "mpc"}) {
    const auto policy = make_baseline(name, small_steps(), {});
    EXPECT_GT(all.profit_eur_per_day_per_mwh(),
              evaluate(small_steps(), small_steps().days, *policy, kCarriedOver)
                  .profit_eur_per_day_per_mwh());
  }
}

TEST(BellmanSweep, EqualsThePlainMaximumForAnyBattery) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    BatteryParameters b;
    b.power_w_max = b.capacity_wh * (0.05 + 40 * std::pow(random.uniform(), 3));
    b.charge_efficiency = 0.5 + 0.5 * random.uniform();
    b.discharge_efficiency = 0.5 + 0.5 * random.uniform();
    b.wear_eur_per_mwh = 20 * random.uniform();
    b.costs = {50 * random.uniform(), 10 * random.uniform(), 10 * random.uniform(),
               10 * random.uniform()};
    b.cold = {.power_share = 0.1 + 0.9 * random.uniform(), .from_hour = 0, .to_hour = 5};
    const SocGrid grid(b, 101);
    const int quarter_hour = n % 2 == 0 ? 19 : 20;
    const auto moves = tabulate_moves(b, grid, b.cold.share_at(quarter_hour));
    std::vector<float> next(101);
    std::vector<float> now(101);
    for (float& v : next) v = static_cast<float>(500 * random.normal());
    const auto price = static_cast<float>(100 * random.normal());
    BellmanSweep(b, grid).run(next.data(), quarter_hour, price, now.data());
    for (int i = 0; i < 101; ++i) {
      double best = next[i];
      for (const int a : {0, 2}) {
        const GridMove& move = moves[static_cast<std::size_t>(a * 101 + i)];
        best = std::max(best, interpolate(next.data(), move.next) -
                                  exchange_cost_eur(b, move.energy_mwh, price));
      }
      ASSERT_NEAR(now[i], best, 0.05) << n << ' ' << i;
    }
  }
}

}  // namespace
}  // namespace bess
