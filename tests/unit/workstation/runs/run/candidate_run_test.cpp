// Comparison of two students: their money, their different decisions, when one is worse.
#include "workstation/runs/run/refresh.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/support/integer_nets.h"
#include "tests/support/small_market.h"
#include "tests/support/tokens.h"
#include "workstation/runs/run/run_backtest.h"

namespace bess {
namespace {

/// Sells from `high` on, buys below `low`, EUR/MWh.
StudentFile trader(int low, int high) {
  const auto at = [](int eur) { return 8 * (eur - kLatticePriceMinEurPerMwh); };
  return {hand_made_net(NetInput::kPrice, -1, at(low), at(high)), {}, "", {}};
}

MarketSteps fold_of_a_month() {
  return market_of_fold(make_market_steps(small_series(75), {}),
                        "2023-02-15 to 2023-03-16, 30 days before");
}

TEST(FoldDays, AreInARecordAndReadBack) {
  const auto days = parse_fold_days("2023-02-15 to 2023-03-16, 30 days before");
  ASSERT_TRUE(days);
  EXPECT_EQ(days->name(), "2023-02-15 to 2023-03-16, 30 days before");
  EXPECT_EQ(days->window_days, 30);
  EXPECT_FALSE(parse_fold_days("2023-02"));
  const MarketSteps fold = fold_of_a_month();
  EXPECT_EQ(fold.days_of(Split::kTest).size(), 30U);
  EXPECT_EQ(fold.days.front().date(), "2023-01-16");
  EXPECT_EQ(fold.days.size(), 60U);
}

TEST(CandidateRun, CountsTheDecisionsThatDifferWhereTheRunsStudentIs) {
  const MarketSteps market = fold_of_a_month();
  const CandidateRun candidate = judge_refit(trader(50, 150), trader(50, 160), market, {});
  std::size_t between = 0;  // where one sells and the other rests, at any charge
  for (const MarketDay& day : market.days_of(Split::kTest)) {
    for (const MarketStep& step : market.of(day)) {
      const auto price = lattice_price_of(price_centi_of(step.observed_eur_per_mwh));
      between += price >= 150 && price < 160 ? 1 : 0;
    }
  }
  ASSERT_GT(between, 100U);
  EXPECT_EQ(candidate.differing.size(), between);
  EXPECT_EQ(candidate.decisions, 30U * 720U);
  EXPECT_THAT(candidate_text(candidate), Names(std::to_string(between) + " discharge idle"));
  for (const DifferingDecision& d : candidate.differing) {
    EXPECT_EQ(d.before, Action::kDischarge);
    EXPECT_EQ(d.now, Action::kIdle);
  }
  const std::string csv = differing_decisions_csv(candidate);
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(csv, '\n')), 1 + between);
  EXPECT_THAT(csv, testing::HasSubstr(",discharge,idle\n"));
}

TEST(CandidateRun, IsWorseBeyondItsErrorAlone) {
  const MarketSteps market = fold_of_a_month();
  const CandidateRun same = judge_refit(trader(50, 150), trader(50, 150), market, {});
  EXPECT_EQ(same.gain.mean, 0);
  EXPECT_FALSE(same.is_worse());
  const StudentFile idle{constant_net(Action::kIdle), {}, "", {}};
  const CandidateRun lost = judge_refit(trader(50, 150), idle, market, {});
  EXPECT_LT(lost.gain.mean, -3 * lost.gain.errors.plain);
  EXPECT_TRUE(lost.is_worse());
  const CandidateRun won = judge_refit(idle, trader(50, 150), market, {});
  EXPECT_FALSE(won.is_worse());
  EXPECT_NEAR(won.gain.mean, -lost.gain.mean, 1e-9);
  EXPECT_NEAR(won.gain.mean, won.now.profit_eur_per_day_per_mwh(), 1e-9) << "idle earns nothing";
  CandidateRun near = same;
  near.gain = {-1.0, {1.1}};
  EXPECT_FALSE(near.is_worse());
  near.gain.errors.plain = 0.9;
  EXPECT_TRUE(near.is_worse());
}

}  // namespace
}  // namespace bess
