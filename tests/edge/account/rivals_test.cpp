// What others would have earned on the same prices: by hand on a few, foresight against every plan
// on short draws, and that nobody beats it.
#include "edge/account/rivals.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace bess {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart = 1'679'785'200;  // midnight in Brussels

/// 8 kWh, 4 kW, from 10 to 100 %.
BatteryParameters battery() { return {.power_w_max = 4'000, .capacity_wh = 8'000}; }

std::vector<PricedCycle> cycles_at(const std::vector<double>& prices_eur) {
  std::vector<PricedCycle> cycles;
  for (std::size_t i = 0; i < prices_eur.size(); ++i) {
    cycles.push_back({kStart + static_cast<std::int64_t>(i) * kSecondsPerStep,
                      static_cast<std::int32_t>(std::lround(prices_eur[i] * 100)), 6});
  }
  return cycles;
}

TEST(Rivals, EarnNothingOnNothing) {
  const Rivals none = find_rivals({}, 0.5, battery(), {});
  EXPECT_EQ(none.foresight_eur, 0);
  BatteryParameters without = battery();
  without.capacity_wh = 0;
  EXPECT_EQ(find_rivals(cycles_at({0, 500}), 0.5, without, {}).rule_eur, 0);
}

/// A quarter of an hour at 0, the same at 100: 1 kWh in, what is left of it out, 90 %.
TEST(Rivals, ForesightBuysCheapAndSellsDear) {
  std::vector<double> prices(15, 0.0);
  prices.resize(30, 100.0);
  const Rivals rivals = find_rivals(cycles_at(prices), 0.10, battery(), {});
  // In 15 cycles 2 kWh are bought; 15 cycles at full power sell as much as they can of them: 1.8.
  EXPECT_NEAR(rivals.foresight_eur, 1.8 * 0.100, 1e-3);
  // The quartiles are the prices themselves: nothing lies beyond them.
  EXPECT_EQ(rivals.rule_eur, 0);
  EXPECT_EQ(rivals.rule_low_centi, 0);
  EXPECT_EQ(rivals.rule_high_centi, 10'000);
}

/// All 3^9 plans, from three states of charge.
TEST(Rivals, ForesightIsTheBestOfAllPlans) {
  std::mt19937_64 random(20'261'123);
  std::uniform_real_distribution<double> price(-100, 300);
  BatteryParameters small = battery();
  small.capacity_wh = 800;  // some cycles fill it
  for (int draw = 0; draw < 6; ++draw) {
    std::vector<double> prices(9);
    for (double& p : prices) p = price(random);
    const auto cycles = cycles_at(prices);
    double mean = 0;
    for (const PricedCycle& cycle : cycles) mean += cycle.price_centi_eur_per_mwh / 100.0 / 9;
    const double first = 0.1 + 0.4 * (draw % 3);
    double best = -1e9;
    for (int plan = 0; plan < 19'683; ++plan) {
      double soc = first;
      double eur = 0;
      for (int i = 0, digits = plan; i < 9; ++i, digits /= 3) {
        const BatteryStep next =
            battery_step(small, soc, (digits % 3 - 1) * small.power_w_max, kHoursPerStep);
        eur -= next.power_w / 30 / 1e6 *
               cycles[static_cast<std::size_t>(i)].price_centi_eur_per_mwh / 100.0;
        soc = next.soc_frac;
      }
      best = std::max(best, eur + (soc - first) * small.capacity_wh / 1e6 * mean);
    }
    const Rivals rivals = find_rivals(cycles, first, small, {});
    EXPECT_LE(rivals.foresight_eur, best + 1e-9) << draw;
    EXPECT_GE(rivals.foresight_eur, best - 0.01 * std::abs(best)) << draw;  // its grid's share
  }
}

TEST(Rivals, NobodyBeatsForesightAndTheThresholdsAreThoseOfTheGuard) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, 60);
  std::vector<double> prices(720);
  for (std::size_t i = 0; i < prices.size(); ++i) {
    prices[i] = 90 + 80 * std::sin(static_cast<double>(i) / 60) + noise(random);
  }
  const auto cycles = cycles_at(prices);
  const Rivals rivals = find_rivals(cycles, 0.5, battery(), {});
  EXPECT_GT(rivals.foresight_eur, rivals.student_eur);
  EXPECT_GT(rivals.foresight_eur, rivals.rule_eur);
  EXPECT_GT(rivals.rule_eur, 0);
  // Thresholds that leave the student nothing: always charging below 2,000 EUR/MWh.
  const Rivals charged =
      find_rivals(cycles, 0.5, battery(), {.low_eur_per_mwh = 2'000, .high_eur_per_mwh = 3'000});
  EXPECT_NE(charged.student_eur, rivals.student_eur);
  EXPECT_EQ(charged.foresight_eur, rivals.foresight_eur);
}

TEST(Rivals, SayTheSameInEachForm) {
  const Rivals rivals{.rule_eur = 1,
                      .student_eur = 2.5,
                      .foresight_eur = 4,
                      .rule_low_centi = 2'000,
                      .rule_high_centi = 9'050};
  const std::string text = rivals_text(rivals, 2);
  EXPECT_THAT(text, HasSubstr("a rule (charge below 20.00, discharge above 90.50) +1.00"));
  EXPECT_THAT(text, HasSubstr("undisturbed +2.50, foresight +4.00 EUR; 50 % of foresight\n"));
  const Json json = Json::parse(rivals_json(rivals, 2).text());
  EXPECT_DOUBLE_EQ(json.value()["share_of_foresight"].number().value(), 0.5);
  EXPECT_DOUBLE_EQ(json.value()["student_undisturbed_eur"].number().value(), 2.5);
  const Json none = rivals_json({}, 0);
  EXPECT_FALSE(none.value()["share_of_foresight"].exists());
}

}  // namespace
}  // namespace bess
