// Fixed-point rounding is defined once: to nearest, halves towards +infinity, below zero as well.
#include "shared/fixed_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/nn/student_net.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

struct ShiftCase {
  std::int32_t value;
  int shift;
  std::int32_t rounded;
};

TEST(FixedPoint, ShiftRoundsHalvesUp) {
  const ShiftCase cases[] = {{0, 5, 0},    {1, 1, 1},   {-1, 1, 0},      {3, 1, 2},   {-3, 1, -1},
                             {5, 2, 1},    {6, 2, 2},   {-6, 2, -1},     {-7, 2, -2}, {-5, 2, -1},
                             {7, 0, 7},    {-7, 0, -7}, {32, 6, 1},      {31, 6, 0},  {-32, 6, 0},
                             {-33, 6, -1}, {1, 30, 0},  {1 << 29, 30, 1}};
  for (const ShiftCase& c : cases) {
    EXPECT_EQ(rounding_shift_right(c.value, c.shift), c.rounded) << c.value << " >> " << c.shift;
  }
}

struct DivideCase {
  std::int32_t numerator, denominator, rounded;
};

TEST(FixedPoint, DivisionRoundsHalvesUp) {
  const DivideCase cases[] = {{0, 7, 0},     {25, 50, 1},   {24, 50, 0},   {-25, 50, 0},
                              {-26, 50, -1}, {-75, 50, -1}, {-76, 50, -2}, {75, 50, 2},
                              {1, 3, 0},     {2, 3, 1},     {-1, 3, 0},    {-2, 3, -1},
                              {7, 1, 7},     {-7, 1, -7}};
  for (const DivideCase& c : cases) {
    EXPECT_EQ(rounding_divide(c.numerator, c.denominator), c.rounded)
        << c.numerator << " / " << c.denominator;
  }
}

TEST(FixedPoint, AgreesWithFloorOfHalfMore) {
  Random random(1);
  for (int i = 0; i < 100'000; ++i) {
    const auto value = static_cast<std::int32_t>(random.index(2'000'000'000)) - 1'000'000'000;
    const int shift = static_cast<int>(random.index(30));
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
