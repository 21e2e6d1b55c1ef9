// Reading of a battery that follows our orders, at medium charge.
#pragma once

#include "edge/core/supervision/response.h"

namespace bess {

inline Response driven_reading(std::int64_t steady_s, std::int32_t ordered_w, std::int32_t power_w,
                               std::int32_t age_s = 120, std::int32_t soc_e4 = 5'000,
                               std::int32_t capacity_wh = 8'000) {
  return {.utc_s = steady_s,
          .steady_s = steady_s,
          .is_driven = true,
          .ordered_power_w = ordered_w,
          .order_age_s = age_s,
          .measurement = {.soc_e4 = soc_e4, .power_w = power_w, .capacity_wh = capacity_wh}};
}

}  // namespace bess
