// Fixed-point rounding is defined once: to nearest, halves towards +infinity, below zero as well.
#include "shared/fixed_point.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shared/features.h"
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

// Features from raw measurements to the lattice: clamps, halves, and every field inside its range.

TEST(Features, SocGoesToTheNearestHalfPercent) {
  const struct {
    std::int32_t soc_e4;
    int index;
  } cases[] = {{0, 0},        {24, 0},      {25, 1},      {26, 1},          {74, 1},
               {75, 2},       {5'000, 100}, {9'974, 199}, {9'975, 200},     {10'000, 200},
               {10'001, 200}, {-1, 0},      {-10'000, 0}, {INT32_MAX, 200}, {INT32_MIN, 0}};
  for (const auto& c : cases) EXPECT_EQ(soc_index_of(c.soc_e4), c.index) << c.soc_e4;
}

TEST(Features, PriceGoesToTheNearestEuroAndIsClamped) {
  const struct {
    std::int32_t centi;
    int euro;
  } cases[] = {{0, 0},
               {49, 0},
               {50, 1},
               {-50, 0},
               {-51, -1},
               {-149, -1},
               {-150, -1},
               {-151, -2},
               {149'949, 1'499},
               {149'950, 1'500},
               {150'000, 1'500},
               {150'001, 1'500},
               {-49'950, -499},
               {-49'951, -500},
               {-50'000, -500},
               {-50'001, -500},
               {1'500'000, 1'500},
               {INT32_MAX, 1'500},
               {INT32_MIN, -500}};
  for (const auto& c : cases) EXPECT_EQ(lattice_price_of(c.centi), c.euro) << c.centi;
}

TEST(Features, StateTakesTheLocalMinute) {
  const LocalMinute now{.year = 2023,
                        .month = 12,
                        .day = 31,
                        .minute_of_day = 1'439,
                        .quarter_hour = 95,
                        .minute_of_quarter_hour = 14};
  EXPECT_EQ(make_lattice_state(now, 12, 1'000, 1'250), (LatticeState{.minute_of_quarter_hour = 14,
                                                                     .quarter_hour = 95,
                                                                     .context_class = 12,
                                                                     .soc_index = 20,
                                                                     .price_eur_per_mwh = 13}));
}

}  // namespace
}  // namespace bess
