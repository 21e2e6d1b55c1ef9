#include "edge/account/quarter_prices.h"

#include <algorithm>

#include "edge/control/quarter_hour_energy.h"
#include "shared/units_and_limits.h"

namespace bess {

void QuarterPrices::note(const CycleRecord& record) {
  const PriceReport& price = record.price;
  if (!price.has_row) return;
  // The tick's own quarter-hour as well: where none of its minutes comes, an older one must do.
  for (const std::int64_t within_utc_s : {price.minute_utc_s, record.utc_s}) {
    Minute& newest = newest_[quarter_hour_of(within_utc_s) * kQuarterHourS];
    if (price.minute_utc_s < newest.utc_s) continue;
    newest = {price.minute_utc_s,
              static_cast<double>(price.price_centi_eur_per_mwh) / kCentiPerEur};
  }
}

std::optional<SettledQuarter> QuarterPrices::find(std::int64_t utc_s) const {
  if (const SettledQuarter* const settled = settled_.find(utc_s)) return *settled;
  const std::int64_t start_utc_s = quarter_hour_of(utc_s) * kQuarterHourS;
  const auto found = newest_.find(start_utc_s);
  if (found == newest_.end()) return std::nullopt;
  return SettledQuarter{start_utc_s, found->second.eur_per_mwh, PriceState::kIndicative};
}

std::optional<double> QuarterPrices::of_step_eur_per_mwh(std::int64_t from_utc_s) const {
  const auto first = find(from_utc_s);
  if (!first) return std::nullopt;
  const std::int64_t end_utc_s = (quarter_hour_of(from_utc_s) + 1) * kQuarterHourS;
  const auto behind_s = std::max<std::int64_t>(from_utc_s + kSecondsPerStep - end_utc_s, 0);
  // The log may end in it, with nothing known of the next.
  const SettledQuarter next = behind_s > 0 ? find(end_utc_s).value_or(*first) : *first;
  const double behind = static_cast<double>(behind_s) / kSecondsPerStep;
  return (1 - behind) * first->eur_per_mwh + behind * next.eur_per_mwh;
}

}  // namespace bess
