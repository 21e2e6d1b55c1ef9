// The money is recomputed from the records with only the prices and the states of charge.
#include "workstation/data/env/evaluate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/market_series.h"
#include "workstation/policy/planners/foresight.h"

namespace bess {
namespace {

/// Draws its actions; knows nothing.
class RandomPolicy final : public Policy {
 public:
  explicit RandomPolicy(std::uint64_t seed) : random_(seed) {}
  [[nodiscard]] Action decide(const MarketStep&, std::size_t, double) const override {
    return static_cast<Action>(random_.index(kActionCount));
  }

 private:
  mutable Random random_;
};

/// Grid energy of a step from the change of the stored energy alone, MWh.
double grid_mwh(const BatteryParameters& battery, double soc_change) {
  const double stored_mwh = soc_change * battery.capacity_wh / 1e6;
  return soc_change > 0 ? stored_mwh / battery.charge_efficiency
                        : stored_mwh * battery.discharge_efficiency;
}

TEST(Evaluate, ProfitCyclesAndSwitchesRecountedFromTheRecords) {
  const MinuteSeries series = random_series("2023-01-31T23:00:00Z", 3 * kMinutesPerDay, 5);
  for (const Settlement settlement : {Settlement::kMinute, Settlement::kStep}) {
    for (const bool carry_soc : {false, true}) {
      const MarketSteps market = make_market_steps(series, {.settlement = settlement});
      RandomPolicy policy(6);
      EvaluationOptions options;
      options.carry_soc = carry_soc;
      std::vector<StepRecord> records;
      const Evaluation result = evaluate(market, market.days, policy, options, &records);
      ASSERT_EQ(result.days.size(), 3u);
      std::size_t at = 0;
      double soc_end = options.initial_soc_frac;
      for (std::size_t d = 0; d < market.days.size(); ++d) {
        if (!carry_soc) soc_end = options.initial_soc_frac;
        const std::size_t end = at + market.days[d].step_count;
        double profit = 0;
        double energy = 0;
        int switches = 0;
        Action last = carry_soc && d > 0 ? records[at - 1].action : Action::kIdle;
        for (; at < end; ++at) {
          ASSERT_DOUBLE_EQ(records[at].soc_frac, soc_end);
          soc_end = at + 1 < end ? records[at + 1].soc_frac : result.days[d].soc_end_frac;
          const double mwh = grid_mwh(options.battery, soc_end - records[at].soc_frac);
          const auto minute =
              static_cast<std::size_t>((records[at].utc_s - series.start_utc_s) / 60);
          const double second = series.settled[minute + (settlement == Settlement::kMinute)];
          profit -= mwh / 2 * series.settled[minute] + mwh / 2 * second;
          energy += std::fabs(mwh);
          switches += records[at].action != last ? 1 : 0;
          last = records[at].action;
        }
        EXPECT_NEAR(result.days[d].profit_eur, profit, 1e-6);
        EXPECT_NEAR(result.days[d].cycles, energy / 16, 1e-9);
        EXPECT_EQ(result.days[d].switches, switches);
      }
      EXPECT_EQ(at, records.size());
    }
  }
}

/// Alternating charge and discharge.
class AlternatingPolicy final : public Policy {
 public:
  [[nodiscard]] Action decide(const MarketStep&, std::size_t index, double) const override {
    return index % 2 == 0 ? Action::kCharge : Action::kDischarge;
  }
};

/// Of 100 EUR/MWh.
MarketSteps flat_day() {
  return make_market_steps(flat_series("2023-01-31T23:00:00Z", kMinutesPerDay, 100), {});
}

TEST(Evaluate, ABatteryThatTakesHalfAMinuteMovesThatMuchLess) {
  const MarketSteps market = flat_day();
  AlternatingPolicy policy;
  EvaluationOptions options;
  options.battery.response.delay_s = 30;
  std::vector<StepRecord> records;
  static_cast<void>(evaluate(market, market.days, policy, options, &records));
  EXPECT_DOUBLE_EQ(records[0].power_w, 0.75 * 4e6) << "from rest";
  EXPECT_DOUBLE_EQ(records[1].power_w, -0.5 * 4e6) << "a quarter of the step flowed the other way";
  EXPECT_DOUBLE_EQ(records[2].power_w, 0.5 * 4e6);
}

TEST(Evaluate, StandbyIsBoughtWhateverThePolicyDoes) {
  const MarketSteps market = flat_day();
  AlternatingPolicy policy;
  EvaluationOptions options;
  const double without = evaluate(market, market.days, policy, options).days[0].profit_eur;
  options.battery.costs.import_adder_eur_per_mwh = 20;
  std::vector<StepRecord> steps;
  const double with_costs =
      evaluate(market, market.days, policy, options, &steps).days[0].profit_eur;
  options.battery.standby_w = 10'000;
  const double with_standby = evaluate(market, market.days, policy, options).days[0].profit_eur;
  EXPECT_LT(with_costs, without);
  const double mwh = 0.01 / 30 * static_cast<double>(steps.size());
  EXPECT_NEAR(with_costs - with_standby, mwh * 120, 1e-9) << "at 100 + 20 EUR/MWh";
}

TEST(Evaluate, FiguresOfSeveralDays) {
  Evaluation result;
  result.capacity_mwh = 2;
  result.days = {{"a", 10, 1, 4, 0.2}, {"b", 30, 2, 6, 0.4}};
  EXPECT_DOUBLE_EQ(result.profit_eur_per_day_per_mwh(), 10);
  EXPECT_DOUBLE_EQ(result.errors().plain, 5);
  EXPECT_DOUBLE_EQ(result.worst_day_eur_per_mwh(), 5);
  EXPECT_DOUBLE_EQ(result.cycles_per_day(), 1.5);
  EXPECT_DOUBLE_EQ(result.switches_per_day(), 5);
  EXPECT_DOUBLE_EQ(result.soc_end_mean(), 0.3);
  Evaluation other = result;
  other.days[0].profit_eur = 6;
  const PairedDifference difference = paired_difference(result, other);
  EXPECT_DOUBLE_EQ(difference.mean, 1);
  EXPECT_DOUBLE_EQ(difference.errors.plain, 1);
  other.days.pop_back();
  EXPECT_THROW(paired_difference(result, other), std::logic_error);
}

Evaluation foresight_on(const MinuteSeries& series, std::vector<StepRecord>* records = nullptr) {
  const MarketSteps market = make_market_steps(series, {});
  ForesightPolicy policy({});
  return evaluate(market, market.days, policy, {}, records);
}

TEST(Foresight, AtAConstantPositivePriceItSellsOnceAndNeverBuys) {
  std::vector<StepRecord> records;
  const Evaluation result =
      foresight_on(flat_series("2023-01-31T22:58:00Z", kMinutesPerDay + 2, 80), &records);
  for (const StepRecord& record : records) ASSERT_LE(record.power_w, 0);
  EXPECT_NEAR(result.days[0].profit_eur, 0.4 * 8 * std::sqrt(0.9) * 80, 1e-3);
  EXPECT_NEAR(result.days[0].soc_end_frac, 0.1, 1e-9);
}

TEST(Foresight, CarriedOverItPlansAcrossMidnight) {
  MinuteSeries series = flat_series("2023-01-31T22:58:00Z", 2 + 2 * kMinutesPerDay, 0);
  for (std::size_t m = 2 + kMinutesPerDay; m < series.size(); ++m) series.settled[m] = 100;
  const MarketSteps market = make_market_steps(series, {});
  ASSERT_EQ(market.days.size(), 2u);
  ForesightPolicy policy({});
  const Evaluation result = evaluate(market, market.days, policy, {{}, 0.5, true});
  EXPECT_NEAR(result.days[0].profit_eur, 0, 1e-9);
  EXPECT_NEAR(result.days[1].profit_eur, 0.9 * 8 * std::sqrt(0.9) * 100, 1e-2);
}

// At a constant negative price the best plan burns energy in the losses, as fast as the power
// allows: with E_c bought and E_d discharged, E_c + E_d = P * 24 h and the store ends full, eta E_c
// - E_d / eta = 0.5 C. The bound must not exceed that.
TEST(Foresight, AtAConstantNegativePriceItEarnsNoMoreThanTheLossesAllow) {
  const double eta = std::sqrt(0.9);
  const double bought_mwh = (4 * 24 + 0.5 * 8 * eta) / (1 + 0.9);
  const double given_back_mwh = 4 * 24 - bought_mwh;
  const double most_eur = 80 * (bought_mwh - given_back_mwh);
  std::vector<StepRecord> records;
  const Evaluation result =
      foresight_on(flat_series("2023-01-31T22:58:00Z", kMinutesPerDay + 2, -80), &records);
  EXPECT_LE(result.days[0].profit_eur, most_eur);
  EXPECT_GE(result.days[0].profit_eur, 0.97 * most_eur);
  for (const StepRecord& record : records) {
    ASSERT_TRUE(record.soc_frac >= 0.1 && record.soc_frac <= 1.0);
  }
}

}  // namespace
}  // namespace bess
