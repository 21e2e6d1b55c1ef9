// Distribution of the training prices, from the student's price map: half distribution, half
// straight line over the lattice (workstation/policy/rl/network_input.h). Every exported header has it.
#pragma once

#include "shared/nn/student_net.h"

namespace bess {

/// First, second or third quartile, whole EUR/MWh.
constexpr std::int32_t learnt_price_quartile(const StudentNet& net, int quartile) {
  constexpr std::int32_t kSteps = kPriceCount - 1;
  for (std::int32_t step = 0; step < kSteps; ++step) {
    // In units of 1 / (kInputOne * kSteps).
    const std::int32_t share = 2 * kSteps * net.price_map[step] - kInputOne * step;
    if (4 * share >= quartile * kInputOne * kSteps) return kLatticePriceMinEurPerMwh + step;
  }
  return kLatticePriceMaxEurPerMwh;
}

}  // namespace bess
