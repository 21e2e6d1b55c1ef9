// Features from raw measurements to the lattice: clamps, halves, and every field inside its range.
#include "shared/features.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

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
