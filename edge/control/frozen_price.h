// A price that does not move although its stamps do: a source that hangs behind a clock that goes on. Told
// after a while, after a longer one no price at all. Pure integers.
//
// How long honest prices stand still, to the cent, measured on 23 November 2026 on Elia's data:
//   the 1,631 real minutes of 6 September 2024 and 8 April 2025: 19 minutes at most (22 between the rows
//     that a controller asks for)
//   52,530 real settled quarter-hours of January 2023 to June 2025: 10 in a row at most (150.00, on
//     29 December 2024); 7 or more 26 times, 9 or more 8 times. The minutes converge to what is settled, so
//     a run of theirs is at most two times 14 minutes longer: under 3 hours, had each of them shown it
// So what stands still for 30 minutes is worth a look, and no honest price stood still for 3 hours.
#pragma once

#include <cstdint>

#include "shared/fixed_point.h"
#include "shared/units_and_limits.h"

namespace bess {

struct FrozenPriceSettings {
  std::int32_t told_s = 1'800;   ///< 0 = never
  std::int32_t stop_s = 10'800;  ///< after this long the price counts as none; 0 = it always counts
};

/// The newest row that a decision saw, and how long its price has stood by then. Kept over restarts: none
/// thaws a price.
struct StandingPrice {
  std::int64_t minute_utc_s = 0;  ///< 0 = no row yet
  std::int32_t centi_eur_per_mwh = 0;
  std::int32_t unchanged_s = 0;  ///< from stamp to stamp, since the price last moved
};

class FrozenPrice {
 public:
  explicit constexpr FrozenPrice(const FrozenPriceSettings& settings) : settings_(settings) {}

  constexpr void restore(const StandingPrice& before) { price_ = before; }

  /// The newest row that a decision sees. Of an outage only a step counts: it neither thaws a price nor
  /// makes two equal rows hours apart a frozen one.
  constexpr void observe(std::int64_t minute_utc_s, std::int32_t centi_eur_per_mwh) {
    const bool stands = price_.minute_utc_s > 0 && centi_eur_per_mwh == price_.centi_eur_per_mwh;
    const std::int64_t since_s = stands ? minute_utc_s - price_.minute_utc_s : 0;
    const std::int64_t stood_s =
        stands ? price_.unchanged_s + clamp_to<std::int64_t>(since_s, 0, kCountedGapS) : 0;
    price_ = {
        .minute_utc_s = minute_utc_s,
        .centi_eur_per_mwh = centi_eur_per_mwh,
        .unchanged_s = static_cast<std::int32_t>(clamp_to<std::int64_t>(stood_s, 0, INT32_MAX))};
  }

  [[nodiscard]] constexpr const StandingPrice& price() const { return price_; }
  [[nodiscard]] constexpr bool is_told() const {
    return settings_.told_s > 0 && price_.unchanged_s >= settings_.told_s;
  }
  [[nodiscard]] constexpr bool is_no_price() const {
    return settings_.stop_s > 0 && price_.unchanged_s >= settings_.stop_s;
  }

 private:
  static constexpr std::int64_t kCountedGapS =
      2 * kSecondsPerStep;  ///< a step, and one that failed

  FrozenPriceSettings settings_;
  StandingPrice price_{};
};

}  // namespace bess
