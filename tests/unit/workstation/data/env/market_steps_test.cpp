// Market as a controller sees it: delay, age, no look-ahead, settlement, splits and the two days of
// the year that are longer or shorter.
#include "workstation/data/env/market_steps.h"

#include <gtest/gtest.h>

#include <limits>

#include "shared/host/user_error.h"
#include "tests/support/market_series.h"

namespace bess {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
/// The indicative price of a minute is its index, so that an observation shows its row.
MinuteSeries numbered_series(std::string_view start_utc, int minutes) {
  MinuteSeries series = flat_series(start_utc, minutes, 50);
  for (std::size_t m = 0; m < series.size(); ++m) series.indicative[m] = static_cast<double>(m);
  return series;
}

std::size_t minute_of(const MinuteSeries& series, const MarketStep& step) {
  return static_cast<std::size_t>((step.utc_s - series.start_utc_s) / 60);
}

TEST(MarketSteps, NewestVisibleRowIsTheDecisionMinuteMinusTheDelay) {
  for (const char* start : {"2023-01-31T23:00:00Z", "2023-01-31T23:01:00Z"}) {
    const MinuteSeries series = numbered_series(start, 2 * kMinutesPerDay);
    for (int delay = 0; delay <= 5; ++delay) {
      const MarketSteps market = make_market_steps(series, {.observation_delay_min = delay});
      for (const MarketStep& step : market.steps) {
        ASSERT_EQ(step.utc_s % kSecondsPerStep, 0);
        ASSERT_EQ(step.observed_eur_per_mwh, static_cast<double>(minute_of(series, step)) - delay);
        ASSERT_EQ(step.observed_age_min, delay);
      }
    }
  }
}

/// The edge refuses such a row, so it must not be in the training data.
TEST(MarketSteps, ARowBeyondPlausibilityIsSkippedAsTheEdgeDoes) {
  MinuteSeries series = numbered_series("2023-01-31T23:00:00Z", kMinutesPerDay);
  series.indicative[101] = 100'000.01;
  series.indicative[103] = -100'000;
  series.indicative[105] = -100'000.01;
  const MarketSteps market = make_market_steps(series, {});
  const auto observed_at = [&](std::size_t minute) {
    return market.steps[minute / 2 - 1].observed_eur_per_mwh;
  };
  EXPECT_EQ(observed_at(102), 100);
  EXPECT_EQ(observed_at(104), -100'000);
  EXPECT_EQ(observed_at(106), 104);
}

TEST(MarketSteps, UnpublishedMinutesLeaveTheLastKnownPriceAndItsAge) {
  MinuteSeries series = numbered_series("2023-01-31T23:00:00Z", kMinutesPerDay);
  for (std::size_t m = 101; m < 108; ++m) series.indicative[m] = kMissing;
  const MarketSteps market = make_market_steps(series, {});
  const struct {
    std::size_t minute;
    double observed;
    int age_min;
  } cases[] = {{100, 99, 1}, {102, 100, 2}, {104, 100, 4}, {108, 100, 8}, {110, 109, 1}};
  for (const auto& c : cases) {
    const MarketStep& step = market.steps[c.minute / 2 - 1];  // minute 0 has seen nothing yet
    ASSERT_EQ(minute_of(series, step), c.minute);
    EXPECT_EQ(step.observed_eur_per_mwh, c.observed) << c.minute;
    EXPECT_EQ(step.observed_age_min, c.age_min) << c.minute;
  }
}

TEST(MarketSteps, AStepAcrossTwoQuarterHoursIsPaidAsTheSettlementSays) {
  MinuteSeries series = flat_series("2023-01-31T23:00:00Z", kMinutesPerDay, 0);
  for (std::size_t m = 0; m < series.size(); ++m) {
    series.settled[m] = static_cast<double>(m / kMinutesPerQuarterHour);
  }
  const MarketSteps by_minute = make_market_steps(series, {.settlement = Settlement::kMinute});
  const MarketSteps by_step = make_market_steps(series, {.settlement = Settlement::kStep});
  for (std::size_t s = 0; s < by_minute.steps.size(); ++s) {
    const std::size_t minute = minute_of(series, by_minute.steps[s]);
    const auto quarter_hour = static_cast<double>(minute / kMinutesPerQuarterHour);
    const bool crosses = minute % kMinutesPerQuarterHour == 14;
    ASSERT_EQ(by_step.steps[s].paid_eur_per_mwh, quarter_hour);
    ASSERT_EQ(by_minute.steps[s].paid_eur_per_mwh, quarter_hour + (crosses ? 0.5 : 0));
  }
}

TEST(MarketSteps, ShortAndLongDaysAreWhole) {
  const struct {
    const char* start_utc;
    int minutes;
    std::size_t steps;
    int quarter_hours_seen;
  } cases[] = {{"2023-03-25T23:00:00Z", 23 * 60, 690, 92},
               {"2023-10-28T22:00:00Z", 25 * 60, 750, 96},
               {"2023-06-09T22:00:00Z", 24 * 60, 720, 96}};
  for (const auto& c : cases) {
    // A day before it, so that its first step has seen a row.
    MinuteSeries series = numbered_series(c.start_utc, kMinutesPerDay + c.minutes);
    series.start_utc_s -= std::int64_t{60} * kMinutesPerDay;
    const MarketSteps market = make_market_steps(series, {});
    ASSERT_FALSE(market.days.empty());
    const MarketDay& day = market.days.back();
    EXPECT_EQ(day.step_count, c.steps) << c.start_utc;
    std::vector<bool> seen(kQuarterHourCount, false);
    for (const MarketStep& step : market.of(day)) {
      seen[static_cast<std::size_t>(step.quarter_hour)] = true;
      ASSERT_TRUE(step.minute_of_quarter_hour >= 0 &&
                  step.minute_of_quarter_hour < kMinuteOfQuarterHourCount);
      const int minute_of_day =
          step.quarter_hour * kMinutesPerQuarterHour + step.minute_of_quarter_hour;
      ASSERT_EQ(step.half_hour_phase, minute_of_day % 30 / 2);
    }
    EXPECT_EQ(std::ranges::count(seen, true), c.quarter_hours_seen) << c.start_utc;
  }
}

TEST(MarketSteps, DaysAreSplitByLocalDayOfMonth) {
  const MarketSteps market =
      make_market_steps(flat_series("2023-01-31T23:00:00Z", 28 * kMinutesPerDay, 1), {});
  ASSERT_EQ(market.days.size(), 28u);
  EXPECT_EQ(market.days[0].date(), "2023-02-01");
  for (const MarketDay& day : market.days) {
    const Split expected = day.day <= 20   ? Split::kTrain
                           : day.day <= 25 ? Split::kValidation
                                           : Split::kTest;
    EXPECT_EQ(day.split, expected) << day.date();
  }
  EXPECT_EQ(market.days_of(Split::kTrain).size(), 20u);
  EXPECT_EQ(market.days_of(Split::kValidation).size(), 5u);
  EXPECT_EQ(market.days_of(Split::kTest).size(), 3u);
  EXPECT_EQ(market.days_of(Split::kAll).size(), 28u);
}

TEST(MarketSteps, DaysUnder690StepsAreDropped) {
  const struct {
    int missing_steps;
    std::size_t days;
  } cases[] = {{0, 2}, {30, 2}, {31, 1}, {720, 1}};
  for (const auto& c : cases) {
    MinuteSeries series = flat_series("2023-01-31T22:58:00Z", 2 + 2 * kMinutesPerDay, 1);
    for (int m = 0; m < 2 * c.missing_steps; ++m) {
      series.settled[static_cast<std::size_t>(2 + kMinutesPerDay + m)] = kMissing;
    }
    const MarketSteps market = make_market_steps(series, {});
    EXPECT_EQ(market.days.size(), c.days) << c.missing_steps;
    EXPECT_EQ(market.of(market.days.back()).size(), market.days.back().step_count);
    for (const MarketDay& day : market.days) EXPECT_GE(day.step_count, kCompleteDaySteps);
  }
}

TEST(MarketSteps, OptionsOutOfRangeAndPricesWithoutADayAreErrors) {
  const MinuteSeries day = flat_series("2023-01-31T23:00:00Z", kMinutesPerDay, 1);
  EXPECT_THROW(make_market_steps(day, {.observation_delay_min = -1}), UserError);
  EXPECT_THROW(make_market_steps(day, {.observation_delay_min = 7}), UserError);
  EXPECT_THROW(make_market_steps(flat_series("2023-01-31T23:00:00Z", 600, 1), {}), UserError);
  EXPECT_THROW(parse_split("training"), UserError);
  EXPECT_THROW(parse_settlement("hour"), UserError);
  EXPECT_EQ(parse_split("val"), Split::kValidation);
  EXPECT_EQ(parse_settlement("step"), Settlement::kStep);
}

}  // namespace
}  // namespace bess
