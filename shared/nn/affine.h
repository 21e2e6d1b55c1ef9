// One affine layer of the student: y = W^T x + b with int16 weights and activations, int32 sums.
// Weights are stored input-major, so the inner loop runs over outputs without a horizontal sum.
// The exporter proves that no accumulator can overflow (student/quantise.h), so there is no check.
#pragma once

#include <cstdint>

namespace bess {

template <int kInputs, int kOutputs>
struct Affine {
  static constexpr int kInputCount = kInputs;
  static constexpr int kOutputCount = kOutputs;

  std::int16_t weight[kInputs][kOutputs];
  std::int32_t bias[kOutputs];

  constexpr void propagate(const std::int16_t (&x)[kInputs], std::int32_t (&y)[kOutputs]) const {
    for (int o = 0; o < kOutputs; ++o) y[o] = bias[o];
    for (int i = 0; i < kInputs; ++i) {
      for (int o = 0; o < kOutputs; ++o) y[o] += std::int32_t{weight[i][o]} * x[i];
    }
  }
};

}  // namespace bess
