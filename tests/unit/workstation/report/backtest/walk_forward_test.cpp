// Walk-forward folds: no data later than the traded month, and no fit on that month; a planted
// look-ahead is found.
#include "workstation/report/backtest/walk_forward.h"

#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/carried_over.h"
#include "tests/support/small_market.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {
namespace {

constexpr int kWindowDays = 40;

MarketSteps four_months(std::uint64_t seed = 7) {
  return make_market_steps(small_series(120, seed), {});
}

FoldPolicy fitted(const char* name) {
  return [name](const Fold& fold) { return make_baseline(name, fold.market, {}); };
}

TEST(Folds, HoldTheirWindowAndTheirMonthAndNothingElse) {
  const MarketSteps market = four_months();
  const Folds folds = make_folds(market, {kWindowDays});
  ASSERT_EQ(folds.traded.size(), 3U);  // of January to April, January has no predecessor
  ASSERT_EQ(folds.skipped.size(), 1U);
  EXPECT_EQ(folds.skipped[0].month, "2023-01");
  for (const Fold& fold : folds.traded) {
    SCOPED_TRACE(fold.month);
    const std::vector<MarketDay> traded = fold.market.days_of(Split::kTest);
    const std::vector<MarketDay> fitted_on = fold.market.days_of(Split::kTrain);
    const std::vector<MarketDay> validated = fold.market.days_of(Split::kValidation);
    ASSERT_FALSE(traded.empty());
    for (const MarketDay& day : traded) EXPECT_TRUE(day.date().starts_with(fold.month));
    for (const auto& days : {fitted_on, validated}) {
      for (const MarketDay& day : days) EXPECT_LT(day.date(), fold.month + "-01");
    }
    EXPECT_LE(fitted_on.size() + validated.size(), std::size_t{kWindowDays});
    EXPECT_EQ(fold.market.days.size(), fitted_on.size() + validated.size() + traded.size());
    const auto last = fold.market.of(traded.back());
    EXPECT_EQ(fold.market.steps.back().utc_s, last.back().utc_s) << "no step after the month";
    for (const MarketDay& day : fold.market.days) {  // the steps are still those of the day
      const auto original = std::ranges::find_if(
          market.days, [&](const MarketDay& d) { return d.date() == day.date(); });
      ASSERT_NE(original, market.days.end());
      EXPECT_EQ(fold.market.of(day).front().utc_s, market.of(*original).front().utc_s);
      EXPECT_EQ(day.step_count, original->step_count);
    }
  }
}

TEST(Folds, OfSevenDaysAndALagLeaveTheDaysBetweenAlone) {
  const MarketSteps market = four_months();
  const Folds weekly = make_folds(market, {.window_days = 40, .lag_days = 30, .traded_days = 7});
  ASSERT_GT(weekly.traded.size(), 6U);
  // The week before has 19 of its 40 days.
  EXPECT_EQ(weekly.traded.front().month, "2023-02-26");
  for (const Fold& fold : weekly.traded) {
    const auto traded = fold.market.days_of(Split::kTest);
    ASSERT_EQ(traded.front().date(), fold.month);
    ASSERT_LE(traded.size(), 7U);
    std::vector<MarketDay> fitted_on = fold.market.days;
    std::erase_if(fitted_on, [](const MarketDay& day) { return day.split == Split::kTest; });
    const std::int64_t between_s = fold.market.of(traded.front()).front().utc_s -
                                   fold.market.of(fitted_on.back()).front().utc_s;
    EXPECT_NEAR(static_cast<double>(between_s) / 86'400, 31, 0.05) << fold.month;
  }
  for (std::size_t f = 1; f < weekly.traded.size(); ++f) {  // no day is omitted or traded twice
    EXPECT_GT(weekly.traded[f].market.days_of(Split::kTest).front().date(),
              weekly.traded[f - 1].market.days_of(Split::kTest).back().date());
  }
}

TEST(Folds, AWindowThatNoMonthHasIsAnError) {
  EXPECT_THROW(make_folds(four_months(), {400}), UserError);
}

TEST(WalkForward, RepeatsBitIdenticallyAndCarriesTheCharge) {
  const MarketSteps market = four_months();
  const Folds folds = make_folds(market, {kWindowDays});
  const WalkForward once = walk_forward("sdp", folds, fitted("sdp"), {}, 0.5, market);
  const WalkForward again = walk_forward("sdp", folds, fitted("sdp"), {}, 0.5, market);
  ASSERT_EQ(once.total.days.size(), again.total.days.size());
  for (std::size_t d = 0; d < once.total.days.size(); ++d) {
    EXPECT_EQ(once.total.days[d].profit_eur, again.total.days[d].profit_eur);
  }
  // The second month starts where the first one ended: traded alone from there it earns the same.
  const Fold& second = folds.traded[1];
  const auto policy = make_baseline("sdp", second.market, {});
  const Evaluation alone = evaluate(second.market, second.market.days_of(Split::kTest), *policy,
                                    {{}, once.by_month[0].days.back().soc_end_frac, true});
  EXPECT_EQ(alone.profit_eur_per_day_per_mwh(), once.by_month[1].profit_eur_per_day_per_mwh());
}

/// Decisions in the first traded month before `until_utc_s`.
std::vector<Action> actions_before(const MinuteSeries& series, const FoldPolicy& make,
                                   std::int64_t until_utc_s) {
  const Folds folds = make_folds(make_market_steps(series, {}), {kWindowDays});
  const Fold& fold = folds.traded.front();
  return actions_before(fold.market, fold.market.days_of(Split::kTest), *make(fold), until_utc_s,
                        {});
}

/// Moves all prices from an instant in the middle of a traded month on, for `instants` consecutive
/// instants, and returns whether any decision changes that was made before they were visible.
bool looks_ahead(const FoldPolicy& make, int instants) {
  const MinuteSeries series = small_series(65);
  std::int64_t noon_utc_s = 0;
  parse_utc("2023-02-14T12:00:00Z", noon_utc_s);
  for (int i = 0; i < instants; ++i) {
    const std::int64_t from_utc_s = noon_utc_s + i * kSecondsPerStep;
    MinuteSeries moved = series;
    for (std::size_t m = 0; m < moved.size(); ++m) {
      if (moved.utc_s(m) < from_utc_s) continue;
      moved.indicative[m] = 200 - moved.indicative[m];
      moved.settled[m] = 400 - moved.settled[m];
    }
    const std::int64_t visible_utc_s = from_utc_s + 60;  // a delay of one minute
    if (actions_before(series, make, visible_utc_s) != actions_before(moved, make, visible_utc_s)) {
      return true;
    }
  }
  return false;
}

TEST(WalkForward, NoPolicyLooksAhead) {
  for (const char* name : {"rbc-tuned", "rbc-quartile", "tabular", "mpc", "sdp"}) {
    EXPECT_FALSE(looks_ahead(fitted(name), 2)) << name;
  }
}

/// Fitted on the traded month itself.
std::shared_ptr<Policy> fit_on_the_traded_month(const Fold& fold) {
  Fold cheating = fold;
  for (MarketDay& day : cheating.market.days) {
    day.split = day.split == Split::kTest ? Split::kTrain : Split::kAll;
  }
  return make_baseline("rbc-quartile", cheating.market, {});
}

TEST(WalkForward, APlantedLookAheadIsFound) {
  EXPECT_TRUE(looks_ahead(fit_on_the_traded_month, 1));
}

}  // namespace
}  // namespace bess
