// What flowed between battery and grid, and when, as far as the decision log can tell: stretches of
// constant power, none across the end of a quarter-hour. The edge reads its ring, the workstation
// the log's CSV: both count by this.
//
// A sample's power was measured some seconds before its tick, so it is that of the order before.
// Between two samples it flows as
//   the power of the older one, until the order of that tick was written; then
//   the power of the newer one.
// When an order was written follows from the age that its price had then. Where the newer power is
// neither the ordered one nor the one before, something ended in between (full, empty, an order cut
// between two ticks), and where a tick or more is missing nobody looked: there the state of charge
// says how much flowed, by the efficiency that the same log shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shared/units_and_limits.h"

namespace bess {

/// What of a cycle with a reading counts here.
struct ExchangeSample {
  std::int64_t utc_s = 0;
  std::int32_t power_w = 0;
  std::int32_t soc_e4 = 0;
  std::int32_t capacity_wh = 0;
  std::int32_t order_w = 0;
  float written_after_s = 0;  ///< the tick; 0: not known
  bool is_ordered = false;    ///< `order_w` is in force from then on

  /// An order that was written when the price of `price_minute_utc_s` was `price_age_s` old; an age
  /// is in whole seconds, cut off: half a one more is right in the mean.
  void set_written(std::int64_t price_minute_utc_s, std::int32_t price_age_s);
};

struct Exchange {
  double from_utc_s = 0;
  double until_utc_s = 0;
  double energy_wh = 0;  ///< grid side, charge positive
  bool is_seen = true;   ///< false: by the state of charge alone, nobody looked

  [[nodiscard]] double charged_wh() const { return std::max(energy_wh, 0.0); }
  [[nodiscard]] double discharged_wh() const { return std::max(-energy_wh, 0.0); }
};

/// What the battery's state of charge says of energy.
struct ChargeScale {
  double charge_efficiency = 0.9486832980505138;     ///< of the specification, until enough is seen
  double discharge_efficiency = 0.9486832980505138;  // [SPEC 3]
  std::int32_t soc_step_e4 = 10;                     ///< the smallest change that it shows
  std::int32_t soc_low_e4 = 0;                       ///< the ends that it was seen at
  std::int32_t soc_high_e4 = kSocFullE4;

  /// Grid side, charge positive.
  [[nodiscard]] double energy_wh(double moved_e4, double capacity_wh) const;
  [[nodiscard]] double moved_e4(double energy_wh, double capacity_wh) const;
  /// Too coarse to tell the efficiency by single stretches.
  [[nodiscard]] bool is_coarse() const { return soc_step_e4 >= 50; }
  [[nodiscard]] bool is_at_an_end(std::int32_t soc_e4) const {
    return !stands_still() && (soc_e4 <= soc_low_e4 || soc_e4 >= soc_high_e4);
  }
  [[nodiscard]] bool stands_still() const { return soc_low_e4 == soc_high_e4; }
};

/// By the stretches in which nothing but one order was in force.
ChargeScale charge_scale_of(std::span<const ExchangeSample> samples);

/// `samples` oldest first; one behind a clock that was stepped back begins anew. The first stands
/// for the step that ends there, as nothing is known before it.
void for_each_exchange(std::span<const ExchangeSample> samples,
                       const std::function<void(const Exchange&)>& visit);

}  // namespace bess
