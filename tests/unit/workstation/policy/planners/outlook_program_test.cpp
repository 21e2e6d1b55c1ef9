// Program by outlook: it plans on published prices only, its sums agree, and it earns where
// day-ahead prices have information.
#include "workstation/policy/planners/outlook_program.h"

#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/carried_over.h"
#include "tests/support/market_series.h"
#include "tests/support/outlook_market.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/policy/planners/stochastic_program.h"

namespace bess {
namespace {

/// Upper bound of the auction's information: day-ahead prices that equal the settled prices, by
/// hour.
DayAheadSeries perfect_day_ahead(const OutlookMarket& market) {
  DayAheadSeries series = market.day_ahead;
  for (std::size_t q = 0; q < series.size(); q += 4) {
    double sum = 0;
    for (std::size_t k = q; k < q + 4; ++k) sum += market.minutes.settled[k * 15] / 4;
    for (std::size_t k = q; k < q + 4; ++k) series.eur_per_mwh[k] = sum;
  }
  return series;
}

/// The first moment from which other day-ahead prices of `delivery` and later change an action.
class OutlookLookAhead : public testing::Test {
 protected:
  OutlookLookAhead()
      : market_(outlook_market({2025, 3, 1}, 36)),
        steps_(market_.steps()),
        days_(steps_.days.begin() + 26, steps_.days.begin() + 30),
        policy_(steps_, {steps_.days.begin(), steps_.days.begin() + 24}, {}) {}

  /// Prices of the local day `delivery` and later, reversed.
  [[nodiscard]] DayAheadSeries turned_from(const LocalDate& delivery) const {
    DayAheadSeries turned = market_.day_ahead;
    for (std::size_t q = 0; q < turned.size(); ++q) {
      if (turned.utc_s(q) >= local_midnight_utc_s(delivery)) {
        turned.eur_per_mwh[q] = 300 - 2 * turned.eur_per_mwh[q];
      }
    }
    return turned;
  }
  /// Whether that changes a decision before the instant, of a market that shows these prices.
  bool changes_before(const MarketSteps& shown, const MarketSteps& turned, std::int64_t until) {
    return actions_before(shown, days_, policy_, until) !=
           actions_before(turned, days_, policy_, until);
  }

  OutlookMarket market_;
  MarketSteps steps_;
  std::vector<MarketDay> days_;
  OutlookPolicy policy_;
};

// 30 March 2025 has 23 hours: its day-ahead prices come on the 29th, at 13:00, which is 12:00 UTC.
TEST_F(OutlookLookAhead, SeesTomorrowFromOneOClockOnAndNotBefore) {
  const MarketSteps turned = market_.steps_with(turned_from({2025, 3, 30}));
  const std::int64_t one_o_clock = utc_of("2025-03-29T12:00:00Z");
  EXPECT_FALSE(changes_before(steps_, turned, one_o_clock));
  EXPECT_TRUE(changes_before(steps_, turned, one_o_clock + 8 * 3600));
  // To the minute: the last decision before and the first one after use the right prices.
  const auto at = [&](const MarketSteps& market, const char* utc) {
    const auto step = std::ranges::find(market.steps, utc_of(utc), &MarketStep::utc_s);
    return step->day_ahead_eur_per_mwh(utc_of("2025-03-30T10:00:00Z"));
  };
  EXPECT_TRUE(std::isnan(at(steps_, "2025-03-29T11:58:00Z")));
  EXPECT_FALSE(std::isnan(at(steps_, "2025-03-29T12:02:00Z")));
  // 12:59 and 13:01, as keys: the decision at 13:00 knows, or does not.
  const MarketSteps early = market_.steps(12 * 60 + 59);
  const MarketSteps late = market_.steps(13 * 60 + 1);
  EXPECT_FALSE(std::isnan(at(early, "2025-03-29T12:00:00Z")));
  EXPECT_TRUE(std::isnan(at(late, "2025-03-29T12:00:00Z")));
  EXPECT_FALSE(std::isnan(at(late, "2025-03-29T12:02:00Z")));
}

// Later prices and levels of the same day are not known yet: reversing future prices changes
// nothing before.
TEST_F(OutlookLookAhead, KnowsNothingOfLaterPricesAndLevels) {
  MinuteSeries moved = market_.minutes;
  const std::int64_t from = utc_of("2025-03-27T09:07:00Z");
  for (std::size_t m = 0; m < moved.size(); ++m) {
    if (moved.utc_s(m) >= from) moved.indicative[m] = 500 - moved.indicative[m];
    if (moved.utc_s(m) >= from) moved.settled[m] = 500 - moved.settled[m];
  }
  MarketSteps other = make_market_steps(moved, {});
  attach_day_ahead(other, steps_.day_ahead);
  EXPECT_FALSE(changes_before(steps_, other, from + 60));
  EXPECT_TRUE(changes_before(steps_, other, from + 6 * 3600));
}

TEST_F(OutlookLookAhead, DecidesTheSameWhereverItIsAskedFirst) {
  std::vector<StepRecord> once, again;
  evaluate(steps_, days_, policy_, kCarriedOver, &once);
  const OutlookPolicy fresh(steps_, {steps_.days.begin(), steps_.days.begin() + 24}, {});
  for (std::size_t i = once.size(); i-- > 0;) {  // backwards, each with a separate plan
    if (i % 371 != 0) continue;
    const auto step = std::ranges::find(steps_.steps, once[i].utc_s, &MarketStep::utc_s);
    ASSERT_EQ(fresh.decide(*step, 0, once[i].soc_frac), once[i].action) << i;
  }
}

TEST_F(OutlookLookAhead, ADayWithoutPricesFallsBackOnWhatIsUsual) {
  DayAheadSeries holed = market_.day_ahead;
  for (std::size_t q = 0; q < holed.size(); ++q) {
    const std::int64_t utc_s = holed.utc_s(q);
    if (utc_s >= local_midnight_utc_s({2025, 3, 27}) && utc_s < local_midnight_utc_s({2025, 3, 29}))
      holed.eur_per_mwh[q] = kNotPublished;
  }
  const MarketSteps without = market_.steps_with(holed);
  const Evaluation e = evaluate(without, days_, policy_, kCarriedOver);
  EXPECT_EQ(e.days.size(), days_.size());
  EXPECT_GT(e.cycles_per_day(), 1);
  const MarketSteps never = make_market_steps(market_.minutes, {});
  EXPECT_GT(evaluate(never, days_, policy_, kCarriedOver).cycles_per_day(), 1);
}

TEST(OutlookProgram, NothingToFitOnIsAnError) {
  const OutlookMarket market = outlook_market({2025, 5, 1}, 3);
  const MarketSteps steps = market.steps();
  EXPECT_THROW(OutlookProgram(steps, {}, {}), UserError);
  EXPECT_THROW(OutlookProgram(make_market_steps(market.minutes, {}), steps.days, {}), UserError);
}

double outlook_gain(const OutlookMarket& market, const DayAheadSeries& day_ahead) {
  const MarketSteps steps = market.steps_with(day_ahead);
  const std::vector<MarketDay> fitted(steps.days.begin(), steps.days.begin() + 60);
  const std::vector<MarketDay> traded(steps.days.begin() + 60, steps.days.end());
  OutlookPolicy outlook(steps, fitted, {});
  StochasticProgramPolicy program(steps, fitted, {});
  return paired_difference(evaluate(steps, traded, outlook, kCarriedOver),
                           evaluate(steps, traded, program, kCarriedOver))
      .mean;
}

// Published prices predict the day: prices that are right by the hour are worth a lot, prices of
// another market next to nothing, in either direction.
TEST(OutlookProgram, EarnsAsMuchAsDayAheadPricesAllow) {
  const OutlookMarket market = outlook_market({2025, 2, 1}, 75);
  const double told = outlook_gain(market, perfect_day_ahead(market));
  const double untold = outlook_gain(market, outlook_market({2025, 2, 1}, 75, 77).day_ahead);
  EXPECT_GT(told, 60);
  EXPECT_LT(std::fabs(untold), 25);
}

// The least squares of usual(), on prices that are a day-ahead price plus a constant.
TEST(OutlookProgram, FindsWhatPricesAreMadeOf) {
  OutlookMarket market = outlook_market({2025, 2, 1}, 40);
  const DayAheadSeries& day_ahead = market.day_ahead;
  for (std::size_t m = 0; m < market.minutes.size(); ++m) {
    market.minutes.settled[m] = 12 + 0.7 * day_ahead.eur_per_mwh[m / 15];
    market.minutes.indicative[m] = market.minutes.settled[m];
  }
  const MarketSteps steps = market.steps();
  const OutlookProgram::Coefficients found = OutlookProgram(steps, steps.days, {}).coefficients();
  EXPECT_NEAR(found.day_ahead, 0.7, 1e-3);
  EXPECT_NEAR(found.hour, 0, 2e-3);
  EXPECT_NEAR(found.level, 0, 2e-3);
  EXPECT_NEAR(found.constant, 12, 0.3);
}

}  // namespace
}  // namespace bess
