#include "workstation/market/quarter_hours_to_minutes.h"

#include <algorithm>

#include "workstation/market/minute_path.h"

namespace bess {

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
    const MinutePrices prices = generator.next(quarter_hour);
    std::copy(prices.begin(), prices.end(), series.indicative.begin() + first);
  }
  return series;
}

}  // namespace bess
