// Fixed-point rounding is defined once: to nearest, halves towards +infinity, below zero as well.
#include "shared/fixed_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/nn/student_net.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

TEST(FixedPoint, AgreesWithFloorOfHalfMore) {
  Random random(1);
  for (int i = 0; i < 100'000; ++i) {
    const auto value = static_cast<std::int32_t>(random.index(2'000'000'000)) - 1'000'000'000;
    const int shift = static_cast<int>(random.index(31));
    const double by_shift = std::floor(std::ldexp(static_cast<double>(value), -shift) + 0.5);
    ASSERT_EQ(rounding_shift_right(value, shift), by_shift) << value << " >> " << shift;
    // Odd denominators have no halves, even ones go up: floor(x + 1/2) in both cases.
    const auto divisor = static_cast<std::int32_t>(1 + random.index(1000));
    const double by_division = std::floor((2.0 * value + divisor) / (2.0 * divisor));
    ASSERT_EQ(rounding_divide(value, divisor), by_division) << value << " / " << divisor;
  }
}

TEST(FixedPoint, ClippedReluSaturatesAndIsMonotone) {
  constexpr ClippedRelu<1> kRelu{.shift = 4};
  static_assert(kRelu.rescale(-1'000'000) == 0);
  static_assert(kRelu.rescale(-8) == 0 && kRelu.rescale(7) == 0 && kRelu.rescale(8) == 1);
  static_assert(kRelu.rescale(INT16_MAX * 16) == INT16_MAX);
  static_assert(kRelu.rescale(INT32_MAX - 8) == INT16_MAX);
  for (std::int32_t x = -100; x < 1'000; ++x) {
    ASSERT_LE(kRelu.rescale(x), kRelu.rescale(x + 1)) << x;
  }
}

}  // namespace
}  // namespace bess
