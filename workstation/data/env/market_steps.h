// Market steps: one record per 2-minute decision with the prices published by then and the price
// that the step is paid. Built once from a minute series and shared by all policies and learners,
// so look-ahead is impossible: `observed_*` never depends on a row later than `decision minute -
// observation delay`.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/units_and_limits.h"
#include "workstation/data/market/series/day_ahead.h"
#include "workstation/data/market/series/imbalance_price.h"

namespace bess {

/// Payment of a step in which a quarter-hour ends [SPEC 4].
enum class Settlement {
  kMinute,  ///< each minute at the price of its own quarter-hour (default)
  kStep,    ///< the whole step at the quarter-hour in which it starts (the paper's wording)
};

/// Held out: validation and test days together.
enum class Split { kTrain, kValidation, kTest, kHeldOut, kAll };
inline constexpr std::array<std::string_view, 5> kSplitNames{"train", "val", "test", "val+test",
                                                             "all"};

/// One of kSplitNames; throws UserError otherwise.
Split parse_split(std::string_view name);
std::string_view split_name(Split split);
/// "minute", "step"; throws UserError otherwise.
Settlement parse_settlement(std::string_view name);

struct MarketOptions {
  int observation_delay_min = 1;  ///< 0..5; the newest visible row at minute t is t - delay
  Settlement settlement = Settlement::kMinute;
  int day_ahead_published_min = kDayAheadPublishedMin;  ///< local minute of the previous day
};

struct MarketStep {
  std::int64_t utc_s;                    ///< start of the step
  double observed_eur_per_mwh;           ///< newest indicative price published by then
  double paid_eur_per_mwh;               ///< mean settled price of the step's two minutes
  std::int32_t level_centi_eur_per_mwh;  ///< trailing level of the prices observed by then
  std::int16_t observed_age_min;         ///< decision minute minus the row's minute
  std::int8_t minute_of_quarter_hour;    ///< local minute of the quarter-hour, 0..14
  std::int8_t quarter_hour;              ///< local, 0..95
  std::int8_t month;                     ///< local, 1..12
  std::int8_t half_hour_phase;           ///< (minute of the half-hour) / 2, 0..14
  const DayAheadPublication* day_ahead = nullptr;  ///< MarketSteps::day_ahead

  /// Day-ahead price of the quarter-hour that contains the instant, as known at this step; NaN if
  /// unknown or without day-ahead prices.
  [[nodiscard]] double day_ahead_eur_per_mwh(std::int64_t at_utc_s) const {
    return day_ahead == nullptr ? kNotPublished : day_ahead->known_eur_per_mwh(at_utc_s, utc_s);
  }
  [[nodiscard]] double level_eur_per_mwh() const {
    return static_cast<double>(level_centi_eur_per_mwh) / kCentiPerEur;
  }
  friend bool operator==(const MarketStep&, const MarketStep&) = default;
  /// Quarter-hours from the newest row's to this step's: 1 in the first minutes.
  [[nodiscard]] int quarter_hours_ago() const {
    const int before_this_min = std::max(0, observed_age_min - minute_of_quarter_hour);
    return (before_this_min + kMinutesPerQuarterHour - 1) / kMinutesPerQuarterHour;
  }
  /// 0..95, of the newest row.
  [[nodiscard]] int row_quarter_hour() const {
    return (quarter_hour - quarter_hours_ago() % kQuarterHourCount + kQuarterHourCount) %
           kQuarterHourCount;
  }
};

/// To the nearest hundredth, as on the edge.
inline std::int32_t price_centi_of(double eur_per_mwh) {
  return static_cast<std::int32_t>(std::lround(eur_per_mwh * kCentiPerEur));
}

/// Consecutive tradable steps of one local calendar day.
struct MarketDay {
  int year, month, day;
  Split split;
  std::size_t first_step;  ///< index into MarketSteps::steps
  std::size_t step_count;
  [[nodiscard]] std::string date() const;  ///< "2023-01-31"
};

struct MarketSteps {
  std::vector<MarketStep> steps;  ///< ascending in time; steps that cannot be settled are absent
  std::vector<MarketDay> days;    ///< complete days only
  std::shared_ptr<const DayAheadPublication> day_ahead{};  ///< none unless attached

  [[nodiscard]] std::span<const MarketStep> of(const MarketDay& day) const {
    return {steps.data() + day.first_step, day.step_count};
  }
  [[nodiscard]] std::vector<MarketDay> days_of(Split split) const;
  /// One price of every step of these days.
  [[nodiscard]] std::vector<double> prices_of(const std::vector<MarketDay>& of_days,
                                              double MarketStep::*price) const;
  /// Training and validation days, used for fitting or selection.
  [[nodiscard]] std::vector<MarketDay> fitted_days() const;
  /// Span of `days`, which are ascending and not empty.
  [[nodiscard]] UtcSpan span_of(const std::vector<MarketDay>& days) const;
};

/// Calls visit(step) for every step of these days.
template <typename Visit>
void for_each_step(const MarketSteps& market, const std::vector<MarketDay>& days, Visit visit) {
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) visit(step);
  }
}

/// Minimum number of tradable steps of a day (a 23-hour day has exactly 690).
inline constexpr std::size_t kCompleteDaySteps = 690;

/// Throws UserError without data to fit on: `count` training days, or prices on them.
void require_training_days(std::size_t count);

/// Throws UserError if options are out of range, a settled price is implausible, or no complete day
/// remains.
MarketSteps make_market_steps(const MinuteSeries& series, const MarketOptions& options);

/// Gives every step of `market` the day-ahead prices known by then.
void attach_day_ahead(MarketSteps& market, std::shared_ptr<const DayAheadPublication> day_ahead);

}  // namespace bess
