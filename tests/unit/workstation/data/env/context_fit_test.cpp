// Context classes of a market: their fit, and their output.
#include "workstation/data/env/context_fit.h"

#include <gmock/gmock.h>

#include "shared/host/user_error.h"
#include "tests/support/small_market.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(ContextFit, LevelsOfTheTrainingDaysAreInside) {
  const MarketSteps& market = small_steps();
  const ContextClasses classes = fit_context_classes(market, ContextKind::kLevel);
  ASSERT_TRUE(classes.is_valid());
  EXPECT_EQ(classes.kind, ContextKind::kLevel);
  int outside = 0;
  int steps = 0;
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) {
      const int found = classes.class_of(step.month, step.level_centi_eur_per_mwh);
      ASSERT_TRUE(found >= 1 && found <= kContextClassCount);
      outside += found == 1 || found == kContextClassCount ? 1 : 0;
      ++steps;
    }
  }
  EXPECT_LT(outside, steps / 20) << "the open classes are for other years";
  const auto& edge = classes.level_edge_eur_per_mwh;
  const int width = edge[1] - edge[0];
  for (int e = 1; e < kContextClassCount - 1; ++e) EXPECT_NEAR(edge[e] - edge[e - 1], width, 1);
}

TEST(ContextFit, AnotherYearsLevelsDoNotMoveTheClasses) {
  MinuteSeries later = small_series();
  const std::size_t half =
      later.size() / 2;  // a February of other prices, days 1 to 20 of January unchanged
  for (std::size_t m = half; m < later.size(); ++m) later.indicative[m] += 5;
  MinuteSeries january = small_series(31);
  const auto fit = [](const MinuteSeries& series) {
    return fit_context_classes(make_market_steps(series, {}), ContextKind::kLevel);
  };
  EXPECT_NE(fit(later), fit(small_series())) << "the training days of February differ now";
  MinuteSeries test_days = january;
  for (std::size_t m = std::size_t{26} * 24 * 60; m < test_days.size(); ++m) {
    test_days.indicative[m] += 300;
  }
  EXPECT_EQ(fit(test_days), fit(january)) << "test days are not used";
}

TEST(ContextFit, AConstantMarketHasClassesToo) {
  const ContextClasses classes =
      fit_context_classes(make_market_steps(constant_series(70), {}), ContextKind::kLevel);
  EXPECT_TRUE(classes.is_valid());
}

TEST(ContextFit, TheLevelOfAClassIsInIt) {
  const ContextClasses classes = fit_context_classes(small_steps(), ContextKind::kLevel);
  for (int c = 1; c <= kContextClassCount; ++c) {
    const double level = class_level_eur_per_mwh(classes, c);
    EXPECT_EQ(classes.class_of(1, static_cast<std::int32_t>(level * kCentiPerEur)), c);
  }
}

TEST(ContextFit, NamesAndTexts) {
  EXPECT_EQ(parse_context("month"), ContextKind::kMonth);
  EXPECT_EQ(parse_context("level"), ContextKind::kLevel);
  EXPECT_THROW((void)parse_context("week"), UserError);
  EXPECT_THAT(context_text({}, 3), Names("March"));
  ContextClasses classes{.kind = ContextKind::kLevel};
  for (int e = 0; e < kContextClassCount - 1; ++e) {
    classes.level_edge_eur_per_mwh[e] = static_cast<std::int16_t>(10 * e);
  }
  EXPECT_THAT(context_text(classes, 1), Names("0 EUR/MWh"));
  EXPECT_THAT(context_text(classes, 2), Names("0 10 EUR/MWh"));
  EXPECT_THAT(context_text(classes, 12), Names("100 EUR/MWh"));
}

}  // namespace
}  // namespace bess
