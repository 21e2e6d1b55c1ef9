// What an imbalance price that is too old to trade on has probably become: of its distance from the
// trailing level a thirtieth goes with each step, so that a third is left after an hour. Measured
// on three years ("When prices stay away", edge/prices/README.md): for half an hour this keeps up
// to two fifths of what a short outage costs; after an hour no guess earns anything.
#pragma once

#include <cstdint>

#include "shared/fixed_point.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Hundredths of EUR/MWh. `age_s` from 0 to a day.
constexpr std::int32_t stand_in_centi(std::int32_t newest_centi, std::int32_t level_centi,
                                      std::int64_t age_s) {
  constexpr std::int64_t kStepsToFade = 30;  ///< time constant of an hour
  std::int64_t distance_centi = std::int64_t{newest_centi} - level_centi;
  for (std::int64_t step = age_s / kSecondsPerStep; step > 0; --step) {
    distance_centi = rounding_divide(distance_centi * (kStepsToFade - 1), kStepsToFade);
  }
  return static_cast<std::int32_t>(level_centi + distance_centi);
}

}  // namespace bess
