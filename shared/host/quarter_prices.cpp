#include "shared/host/quarter_prices.h"

#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr std::int64_t start_of(std::int64_t utc_s) {
  return utc_s / kSecondsPerQuarterHour * kSecondsPerQuarterHour;
}

}  // namespace

QuarterPrices::QuarterPrices(std::span<const SettledQuarter> settled) {
  for (const SettledQuarter& quarter : settled) prices_[quarter.start_utc_s].quarter = quarter;
}

void QuarterPrices::note(std::int64_t tick_utc_s, std::int64_t minute_utc_s, double eur_per_mwh) {
  // The tick's own quarter-hour as well: where none of its minutes comes, an older one must do.
  for (const std::int64_t start_utc_s : {start_of(minute_utc_s), start_of(tick_utc_s)}) {
    const auto [at, is_new] = prices_.try_emplace(start_utc_s);
    Price& price = at->second;
    const bool is_settled = !is_new && price.quarter.state != PriceState::kIndicative;
    if (is_settled || minute_utc_s < price.minute_utc_s) continue;
    price = {minute_utc_s, {start_utc_s, eur_per_mwh, PriceState::kIndicative}};
  }
}

std::optional<SettledQuarter> QuarterPrices::find(std::int64_t utc_s) const {
  const auto found = prices_.find(start_of(utc_s));
  return found == prices_.end() ? std::nullopt : std::optional(found->second.quarter);
}

}  // namespace bess
