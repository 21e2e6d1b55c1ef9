// Is the load that meter and battery leave for the house one that a house can have? House = grid
// - battery; below zero it generates, and no more than its panels can. An inverted meter or
// battery, an offset, a meter on another phase show as "house -631 W". Told, not acted on:
// whoever has panels and has not said so would lose his battery to the sun.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/control/site_types.h"

namespace bess {

/// Of both meters together, with that much of the battery's power besides: it is read a moment
/// earlier than the grid.
inline constexpr std::int64_t kHouseErrorW = 200;
inline constexpr std::int64_t kHouseErrorShare = 20;

/// `pv_w_max`: what the panels behind the meter can give; kAnyPowerW: not known.
constexpr bool is_plausible_house(std::int32_t grid_w, std::int32_t battery_w,
                                  std::int32_t pv_w_max) {
  if (pv_w_max == kAnyPowerW) return true;
  const std::int64_t battery_magnitude_w =
      std::max<std::int64_t>(battery_w, -std::int64_t{battery_w});
  const std::int64_t error_w = kHouseErrorW + battery_magnitude_w / kHouseErrorShare;
  return std::int64_t{grid_w} - battery_w >= -std::int64_t{pv_w_max} - error_w;
}

class HouseWatch {
 public:
  /// Readings in a row that begin and end it: one falls into a ramp.
  static constexpr std::int32_t kReadings = 4;

  void observe(bool is_plausible) {
    if (is_plausible != is_implausible_) {
      readings_ = 0;
    } else if (++readings_ >= kReadings) {
      is_implausible_ = !is_plausible;
      readings_ = 0;
    }
  }
  [[nodiscard]] bool is_implausible() const { return is_implausible_; }

 private:
  bool is_implausible_ = false;
  std::int32_t readings_ = 0;  ///< in a row that say otherwise
};

}  // namespace bess
