// How quickly and how exactly a device follows an order: its register map says it ([response]), the
// supervision of its answers judges by it.
#pragma once

#include <algorithm>
#include <cstdint>

namespace bess {

struct ResponseBand {
  std::int32_t settle_s = 20;           ///< from an order to the power that answers it
  std::int32_t tolerance_percent = 15;  ///< of the ordered power
  std::int32_t tolerance_w = 200;       ///< own consumption and error of the meter, at any power
  std::int32_t soc_step_e4 = 100;   ///< the smallest change of the state of charge that it shows
  std::int32_t soc_refresh_s = 60;  ///< as old as that the state of charge may be
  bool charges_by_itself = false;   ///< surplus PV charges it, whatever is ordered

  /// What measured power may be off by at any power; also 2.5 % of the rating: a large battery's
  /// pumps and fans.
  [[nodiscard]] constexpr std::int32_t noise_w(std::int32_t rated_w) const {
    return std::max(tolerance_w, rated_w / 40);
  }
  /// By how much power that answers an order of that size may differ from it.
  [[nodiscard]] constexpr std::int32_t tolerance_of_w(std::int32_t rated_w,
                                                      std::int32_t ordered_w) const {
    const std::int64_t share_w = std::int64_t{ordered_w} * tolerance_percent / 100;
    return std::max(noise_w(rated_w), static_cast<std::int32_t>(share_w));
  }
};

}  // namespace bess
