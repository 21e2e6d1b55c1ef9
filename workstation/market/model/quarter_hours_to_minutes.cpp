#include "workstation/market/model/quarter_hours_to_minutes.h"

#include <algorithm>

#include "workstation/market/model/minute_path.h"
#include "workstation/market/model/price_rounding.h"

namespace bess {
namespace {

/// Median |SI| of the 13,650 quarter-hours of ods047, 1 January to 23 May 2023; below alpha's 150
/// MW.
constexpr double kTypicalImbalance_mw = 92;
constexpr std::size_t kQuarterHoursBack = 96;

/// Median price of up to a day that ends with quarter-hour `index`.
double recent_median(const std::vector<QuarterHour>& quarter_hours, std::size_t index) {
  std::vector<double> prices;
  const std::size_t first = index + 1 > kQuarterHoursBack ? index + 1 - kQuarterHoursBack : 0;
  for (std::size_t i = first; i <= index; ++i) {
    const double price = quarter_hours[i].price_eur_per_mwh;
    if (is_published(price)) prices.push_back(price);
  }
  const auto middle = prices.begin() + static_cast<std::ptrdiff_t>(prices.size() / 2);
  std::nth_element(prices.begin(), middle, prices.end());
  return *middle;
}

}  // namespace

std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours) {
  std::size_t filled = 0;
  for (std::size_t i = 0; i < quarter_hours.size(); ++i) {
    QuarterHour& row = quarter_hours[i];
    if (is_published(row.system_imbalance_mw) || !is_published(row.price_eur_per_mwh)) continue;
    const bool shortage = row.price_eur_per_mwh > recent_median(quarter_hours, i);
    row.system_imbalance_mw = shortage ? -kTypicalImbalance_mw : kTypicalImbalance_mw;
    ++filled;
  }
  return filled;
}

MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed) {
  MinuteSeries series;
  series.start_utc_s = quarter_hours.front().utc_s;
  const std::int64_t span_s =
      quarter_hours.back().utc_s - series.start_utc_s + kSecondsPerQuarterHour;
  series.indicative.assign(static_cast<std::size_t>(span_s / 60), kNotPublished);
  series.settled = series.indicative;
  MinutePathGenerator generator(seed);
  for (const QuarterHour& quarter_hour : quarter_hours) {
    if (!is_published(quarter_hour.price_eur_per_mwh)) continue;
    const auto first = static_cast<std::ptrdiff_t>((quarter_hour.utc_s - series.start_utc_s) / 60);
    std::fill_n(series.settled.begin() + first, kMinutesPerQuarterHour,
                quarter_hour.price_eur_per_mwh);
    if (!is_published(quarter_hour.system_imbalance_mw)) continue;
    MinutePrices prices = generator.next(quarter_hour);
    std::transform(prices.begin(), prices.end() - 1, prices.begin(), in_cents);
    std::copy(prices.begin(), prices.end(), series.indicative.begin() + first);
  }
  return series;
}

}  // namespace bess
