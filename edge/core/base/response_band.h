// Response band: speed and tolerance with which a device follows an order, from [response] of its
// register map. Input of the supervision.
#pragma once

#include <algorithm>
#include <cstdint>

namespace bess {

/// An order is read about 117 s after it was given, and must have settled by then.
inline constexpr std::int32_t kSettleSMax = 100;

struct ResponseBand {
  std::int32_t settle_s = 20;           ///< from an order until the power has settled
  std::int32_t tolerance_percent = 15;  ///< of the ordered power
  std::int32_t tolerance_w = 200;       ///< own consumption and meter error, at any power
  std::int32_t soc_step_e4 = 100;       ///< resolution of the state of charge
  std::int32_t soc_refresh_s = 60;      ///< maximum age of the state of charge
  bool charges_by_itself = false;       ///< surplus PV charges it, independent of the order

  /// Power error at any power, at least 2.5 % of the rating: pumps and fans of a large battery.
  [[nodiscard]] constexpr std::int32_t noise_w(std::int32_t rated_w) const {
    return std::max(tolerance_w, rated_w / 40);
  }
  /// Permitted difference between measured and ordered power.
  [[nodiscard]] constexpr std::int32_t tolerance_of_w(std::int32_t rated_w,
                                                      std::int32_t ordered_w) const {
    const std::int64_t share_w = std::int64_t{ordered_w} * tolerance_percent / 100;
    return std::max(noise_w(rated_w), static_cast<std::int32_t>(share_w));
  }
};

}  // namespace bess
