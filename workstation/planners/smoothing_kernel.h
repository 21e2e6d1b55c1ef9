// The weight of a neighbour in a smoothed mean.
#pragma once

#include <cmath>

namespace bess {

/// Gaussian, not normalised; `sigma` in the same steps as `distance`, 0: no smoothing.
inline double smoothing_kernel(int distance, double sigma) {
  if (sigma <= 0) return distance == 0 ? 1.0 : 0.0;
  return std::exp(-0.5 * distance * distance / (sigma * sigma));
}

}  // namespace bess
