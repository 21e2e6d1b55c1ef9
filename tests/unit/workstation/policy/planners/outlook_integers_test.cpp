// Integer plan against the program: its break-even prices separate charging from discharging where
// the program's own values do, and a policy's plan cache returns them in any order of requests.
#include "workstation/policy/planners/outlook_program.h"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/outlook_market.h"
#include "workstation/base/random.h"
#include "workstation/data/env/context_fit.h"
#include "workstation/data/env/plan_cache.h"

namespace bess {
namespace {

class OutlookIntegers : public testing::Test {
 protected:
  OutlookIntegers()
      : market_(outlook_market({2025, 3, 1}, 40)),
        steps_(market_.steps()),
        program_(steps_, {steps_.days.begin(), steps_.days.begin() + 26}, {}),
        model_(outlook_integers(program_)),
        plan_cache_(model_) {}

  OutlookMarket market_;
  MarketSteps steps_;
  OutlookProgram program_;
  OutlookModel model_;
  PlanCache plan_cache_;
};

TEST_F(OutlookIntegers, DivideChargingFromDischargingWhereTheProgramDoes) {
  Random random(3);
  OutlookProgram::Plan plan;
  double lost_eur = 0, at_stake_eur = 0;
  for (std::size_t d = 26; d < steps_.days.size(); d += 3) {
    for (const MarketStep& step : steps_.of(steps_.days[d])) {
      if (!plan.serves(step)) plan = program_.plan_of(step);
      const double soc_frac = 0.15 + 0.8 * random.uniform();
      const auto worth = program_.action_values(step, soc_frac, plan);
      const bool charges =
          step.observed_eur_per_mwh * kCentiPerEur < plan_cache_.break_even_centi(step, soc_frac);
      at_stake_eur += std::abs(worth[2] - worth[0]);
      lost_eur += std::max(0.0, charges ? worth[0] - worth[2] : worth[2] - worth[0]);
    }
  }
  EXPECT_LT(lost_eur, 0.02 * at_stake_eur);
  EXPECT_GT(at_stake_eur, 1000);
}

TEST_F(OutlookIntegers, ThePlanCacheAnswersTheSameInAnyOrderAndFromThreads) {
  const MarketDay& day = steps_.days[29];  // of a change of clocks
  std::vector<std::int32_t> forward;
  for (const MarketStep& step : steps_.of(day)) {
    forward.push_back(plan_cache_.break_even_centi(step, 0.4));
  }
  const PlanCache other(model_);
  std::vector<std::int32_t> backward(forward.size());
  const auto ask = [&](std::size_t first) {
    for (std::size_t i = first; i < forward.size(); i += 2) {
      const std::size_t at = forward.size() - 1 - i;
      backward[at] = other.break_even_centi(steps_.of(day)[at], 0.4);
    }
  };
  std::thread even(ask, 0);
  ask(1);
  even.join();
  EXPECT_EQ(forward, backward);
  const PlanCache prepared(model_);
  prepared.prepare(steps_, {steps_.days.begin() + 28, steps_.days.begin() + 32}, 3);
  for (std::size_t i = 0; i < forward.size(); ++i) {
    ASSERT_EQ(prepared.break_even_centi(steps_.of(day)[i], 0.4), forward[i]) << i;
  }
}

// Steps of the same time need not be the same step: with another price it is another.
TEST_F(OutlookIntegers, WhatTheProgramKeepsIsOfTheVeryStepThatIsAsked) {
  program_.prepare(steps_, {steps_.days.begin() + 28, steps_.days.begin() + 31}, 2);
  OutlookProgram::Plan plan, kept_plan, other_plan;
  int differ = 0;
  for (const MarketStep& step : steps_.of(steps_.days[29])) {
    if (!plan.serves(step)) plan = program_.plan_of(step);
    const auto worth = program_.action_values(step, 0.4, plan);
    ASSERT_EQ(program_.kept_action_values(step, 0.4, kept_plan), worth);
    MarketStep dearer = step;
    dearer.observed_eur_per_mwh += 70;
    const auto dearer_worth = program_.action_values(dearer, 0.4, plan);
    ASSERT_EQ(program_.kept_action_values(dearer, 0.4, other_plan), dearer_worth);
    differ += worth != dearer_worth ? 1 : 0;
  }
  EXPECT_GT(differ, 600);
}

// A run's teacher and students plan once.
TEST_F(OutlookIntegers, OneModelHasOnePlanCacheWhileItIsInUse) {
  const auto plan_cache = PlanCache::of(model_);
  EXPECT_EQ(PlanCache::of(model_), plan_cache);
  OutlookModel other = model_;
  ++other.constant_centi;
  EXPECT_EQ(PlanCache::of(other)->model().constant_centi, other.constant_centi);
}

TEST_F(OutlookIntegers, EachClassHoldsAsManyBreakEvenPrices) {
  const ContextClasses classes = fit_outlook_classes(steps_, plan_cache_);
  EXPECT_TRUE(classes.is_valid());
  std::array<int, kContextClassCount> count{};
  Random random(8);
  int all = 0;
  for (const MarketDay& day : steps_.days_of(Split::kTrain)) {
    for (const MarketStep& step : steps_.of(day)) {
      const std::int32_t price = plan_cache_.break_even_centi(step, 0.1 + 0.9 * random.uniform());
      ++count[static_cast<std::size_t>(classes.class_of(step.month, price) - 1)];
      ++all;
    }
  }
  for (const int in_class : count) EXPECT_NEAR(in_class, all / 12.0, all / 40.0);
}

}  // namespace
}  // namespace bess
