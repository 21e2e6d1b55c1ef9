// Energy flow reconstructed from the decision log: stretches of constant power, split at
// quarter-hours. Used for the ring on the edge and the CSV log on the workstation.
//
// The power of a sample is measured some seconds before its tick, so it belongs to the previous
// order. Between two samples:
//   power of the older one, until the order of that tick was written; then
//   power of the newer one.
// The time of a write follows from the age of its price. If the newer power is neither the ordered
// nor the previous one, something ended in between (full, empty, an order cut between two ticks);
// and after missed ticks there are no samples. Then the state of charge gives the energy, with the
// efficiency found in the same log.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shared/units_and_limits.h"

namespace bess {

/// Relevant values of a control cycle with a reading.
struct ExchangeSample {
  std::int64_t utc_s = 0;
  std::int32_t power_w = 0;
  std::int32_t soc_e4 = 0;
  std::int32_t capacity_wh = 0;
  std::int32_t order_w = 0;
  float written_after_s = 0;  ///< after the tick; 0: unknown
  bool is_ordered = false;    ///< `order_w` is in force from then

  /// Order written when the price of `price_minute_utc_s` had the age `price_age_s`, truncated to
  /// whole seconds: adds half a second.
  void set_written(std::int64_t price_minute_utc_s, std::int32_t price_age_s);
};

struct Exchange {
  double from_utc_s = 0;
  double until_utc_s = 0;
  double energy_wh = 0;  ///< grid side, charge positive
  bool is_seen = true;   ///< false: from the state of charge only

  [[nodiscard]] double charged_wh() const { return std::max(energy_wh, 0.0); }
  [[nodiscard]] double discharged_wh() const { return std::max(-energy_wh, 0.0); }
};

/// Relation of state of charge and energy.
struct ChargeScale {
  double charge_efficiency = 0.9486832980505138;     ///< default until known from the log
  double discharge_efficiency = 0.9486832980505138;  // [SPEC 3]
  std::int32_t soc_step_e4 = 10;                     ///< smallest displayed change
  std::int32_t soc_low_e4 = 0;                       ///< observed limits
  std::int32_t soc_high_e4 = kSocFullE4;

  /// Grid side, charge positive.
  [[nodiscard]] double energy_wh(double moved_e4, double capacity_wh) const;
  [[nodiscard]] double moved_e4(double energy_wh, double capacity_wh) const;
  /// Too coarse for the efficiency of single stretches.
  [[nodiscard]] bool is_coarse() const { return soc_step_e4 >= 50; }
  [[nodiscard]] bool is_at_an_end(std::int32_t soc_e4) const {
    return !stands_still() && (soc_e4 <= soc_low_e4 || soc_e4 >= soc_high_e4);
  }
  [[nodiscard]] bool stands_still() const { return soc_low_e4 == soc_high_e4; }
};

/// From stretches with a single order in force.
ChargeScale charge_scale_of(std::span<const ExchangeSample> samples);

/// `samples` oldest first; a backward clock step restarts. The first sample represents the step
/// that ends there.
void for_each_exchange(std::span<const ExchangeSample> samples,
                       const std::function<void(const Exchange&)>& visit);

}  // namespace bess
