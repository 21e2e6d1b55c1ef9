// ReLU with rescaling from the int32 accumulator to the next layer's int16 activation:
// y = clamp(round(x / 2^shift), 0, 32767). Monotone, which the proof's interval bounds rely on.
#pragma once

#include <cstdint>

#include "shared/fixed_point.h"

namespace bess {

template <int kCount>
struct ClippedRelu {
  std::int32_t shift;  ///< 0..30; differs by net, because each net uses the full range of int16

  constexpr std::int16_t rescale(std::int32_t x) const {
    return static_cast<std::int16_t>(
        clamp_to<std::int32_t>(rounding_shift_right(x, shift), 0, INT16_MAX));
  }
  constexpr void propagate(const std::int32_t (&x)[kCount], std::int16_t (&y)[kCount]) const {
    for (int i = 0; i < kCount; ++i) y[i] = rescale(x[i]);
  }
};

}  // namespace bess
