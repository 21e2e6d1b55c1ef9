// One reading of the battery with the order that it followed: input of the supervision.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/core/base/response_band.h"
#include "edge/core/control/control_types.h"

namespace bess {

/// Below this, in 0.1 degC, charging may be reduced or refused.
inline constexpr std::int32_t kColdDeciC = 80;
/// One lost reading, and the intervals of both; beyond it, the power in between is unknown.
inline constexpr std::int64_t kReadingGapMaxS = 300;

/// Negation; INT32_MIN, which a device may send, saturates.
constexpr std::int32_t opposite_power_w(std::int32_t power_w) {
  return -std::max(power_w, -INT32_MAX);
}

constexpr std::int32_t power_magnitude_w(std::int32_t power_w) {
  return power_w < 0 ? opposite_power_w(power_w) : power_w;
}

struct ResponseSettings {
  ResponseBand band;
  std::int32_t power_w = 4'000;      ///< rated
  std::int32_t capacity_wh = 8'000;  ///< if the device reports none

  [[nodiscard]] constexpr std::int32_t noise_w() const { return band.noise_w(power_w); }
  /// Permitted difference between response and order.
  [[nodiscard]] constexpr std::int32_t tolerance_w(std::int32_t ordered_w) const {
    return band.tolerance_of_w(power_w, power_magnitude_w(ordered_w));
  }
};

/// One reading, and the order that the battery followed at that time.
struct Response {
  std::int64_t utc_s = 0;
  std::int64_t steady_s = 0;      ///< without clock steps of this run: for durations
  bool is_driven = false;         ///< false: the battery is in its own mode
  std::int64_t order_number = 0;  ///< unique for every confirmed order
  std::int32_t ordered_power_w = 0;
  std::int32_t order_age_s = 0;          ///< since this power was first ordered
  std::int32_t soc_floor_e4 = 1'000;     ///< where the device itself stops discharging
  std::int32_t soc_ceiling_e4 = 10'000;  ///< where it stops charging
  BatteryMeasurement measurement;
};

}  // namespace bess
