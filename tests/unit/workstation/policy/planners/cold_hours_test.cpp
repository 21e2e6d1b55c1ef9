// Cold hours in plan and evaluation: a battery that is cold all day is one of less power, to the
// last bit of every plan; planning for one that is cold at night gains.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shared/battery_keys.h"
#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/policy/rl/train.h"

namespace bess {
namespace {

constexpr ColdHours kNights{.power_share = 0.6, .from_hour = 22.5, .to_hour = 7};

BatteryParameters with_cold(const ColdHours& cold) {
  BatteryParameters battery;
  battery.cold = cold;
  return battery;
}

TEST(ColdHours, MayGoOverMidnightAndAreNoneUnlessSet) {
  EXPECT_EQ(ColdHours{}.share_at(0), 1);
  for (int q = 0; q < 96; ++q) {
    const bool is_night = q >= 90 || q < 28;
    EXPECT_EQ(kNights.share_at(q), is_night ? 0.6 : 1) << q;
  }
  const ColdHours morning{.power_share = 0.5, .from_hour = 2, .to_hour = 7};
  EXPECT_FALSE(morning.hold(7));
  EXPECT_TRUE(morning.hold(8));
  EXPECT_TRUE(morning.hold(27));
  EXPECT_FALSE(morning.hold(28));
}

TEST(ColdHours, KeysThatSayNothingTogetherAreRefused) {
  EXPECT_EQ(battery_contradiction(with_cold(kNights)), nullptr);
  EXPECT_NE(battery_contradiction(with_cold({.power_share = 0.6})), nullptr);
  EXPECT_EQ(battery_contradiction(with_cold({.from_hour = 3})), nullptr) << "there are none";
}

Evaluation trade(const std::string& name, const BatteryParameters& planned,
                 const BatteryParameters& real, std::vector<StepRecord>* records = nullptr) {
  const auto policy = make_baseline(name, small_steps(), planned);
  return evaluate(small_steps(), small_steps().days_of(Split::kTest), *policy, {real, 0.5, true},
                  records);
}

TEST(ColdHours, AllDayTheyAreABatteryOfLessPower) {
  const BatteryParameters cold = with_cold({.power_share = 0.6, .from_hour = 0, .to_hour = 24});
  BatteryParameters smaller;
  smaller.power_w_max = 0.6 * cold.power_w_max;
  for (const char* name : {"sdp", "mpc", "foresight"}) {
    const Evaluation a = trade(name, cold, cold), b = trade(name, smaller, smaller);
    for (std::size_t d = 0; d < a.days.size(); ++d) {
      EXPECT_EQ(a.days[d].profit_eur, b.days[d].profit_eur) << name << ' ' << d;
    }
  }
}

TEST(ColdHours, NoMoreFlowsAndKnowledgeOfThemEarnsMore) {
  const BatteryParameters cold = with_cold(kNights);
  for (const char* name : {"sdp", "mpc", "foresight"}) {
    std::vector<StepRecord> records;
    const double knows = trade(name, cold, cold, &records).profit_eur_per_day_per_mwh();
    double night_w = 0, day_w = 0;
    for (const StepRecord& r : records) {
      double& most_w = kNights.hold(local_minute_of(r.utc_s).quarter_hour) ? night_w : day_w;
      most_w = std::max(most_w, std::fabs(r.power_w));
    }
    EXPECT_EQ(night_w, 0.6 * cold.power_w_max) << name;
    EXPECT_EQ(day_w, cold.power_w_max) << name;
    if (std::string(name) != "mpc") {  // a naive forecast need not gain from this knowledge
      EXPECT_GT(knows, trade(name, {}, cold).profit_eur_per_day_per_mwh()) << name;
    }
    EXPECT_LT(knows, trade(name, {}, {}).profit_eur_per_day_per_mwh()) << name;
  }
}

TEST(ColdHours, TheLearnerIsPaidForWhatFlows) {
  const PriceMap map = PriceMap::fit(observed_training_prices(small_steps()));
  const TrainingMarket warm(small_steps(), map, {}, Horizon::kContinuing, {});
  const TrainingMarket cold(small_steps(), map, with_cold(kNights), Horizon::kContinuing, {});
  constexpr std::size_t kNoon = 360, kThree = 90;  // steps of the first day, 2 minutes each
  Transition a, b;
  const double warm_frac = warm.make_transition(kThree, 0.5, Action::kCharge, a) - 0.5;
  const double cold_frac = cold.make_transition(kThree, 0.5, Action::kCharge, b) - 0.5;
  EXPECT_NEAR(cold_frac, 0.6 * warm_frac, 1e-12);
  EXPECT_NEAR(b.reward, 0.6 * a.reward, 1e-6);
  EXPECT_EQ(warm.make_transition(kNoon, 0.5, Action::kCharge, a),
            cold.make_transition(kNoon, 0.5, Action::kCharge, b));
  EXPECT_EQ(a.reward, b.reward);
}

}  // namespace
}  // namespace bess
