// Faults that the counts forgive are found by what they move, whatever their rhythm: the bound of
// edge/core/supervision/energy_balance.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/system/trial/rare_faults.h"

namespace bess::trial {
namespace {

constexpr double kFoundPercent = WrongEnergy::kFoundE6 / 1e4;
constexpr double kToldPercent = WrongEnergy::kToldE6 / 1e4;

class RareFault : public ::testing::TestWithParam<const char*> {};

TEST_P(RareFault, IsToldAndTripsBeforeTwiceTheBound) {
  for (const Rhythm& rhythm : kRhythms) {
    for (const Orders orders : kRareOrders) {
      for (const double soc_frac : {0.15, 0.45, 0.85}) {
        const FaultResult r = try_rare(GetParam(), rhythm, orders, soc_frac);
        if (r.wrong_wh == 0) continue;  // it never met an order that it is a fault of
        SCOPED_TRACE(std::string(rhythm.name) + ", " + std::string(orders_name(orders)) +
                     ", from " + std::to_string(soc_frac) + ": " + say_rare(r));
        EXPECT_TRUE(r.is_trip) << reason_name(r.reason);
        EXPECT_EQ(r.driven_after, 0);
        EXPECT_LT(percent_of_capacity(r.wrong_wh), 2 * kFoundPercent);
        const bool is_told = r.wrong_until_told_wh > 0;
        const double until_told_wh = is_told ? r.wrong_until_told_wh : r.wrong_wh;
        EXPECT_LT(percent_of_capacity(until_told_wh), 2 * kToldPercent);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Faults, RareFault, ::testing::ValuesIn(kRareFaults),
                         [](const auto& info) { return std::string(info.param); });

TEST(RareFaults, AreFoundThoughTheControllerIsKilledAfterEachCycle) {
  const FaultResult r = try_fault({.fault = &trial_fault("inverted"),
                                   .times = {.every = 10},
                                   .orders = Orders::kHours,
                                   .is_killed = true,
                                   .cycles_max = 2 * kStepsPerDay});
  EXPECT_EQ(r.reason, Reason::kWrongDirection) << say_rare(r);
  EXPECT_LT(percent_of_capacity(r.wrong_wh), kFoundPercent + 5);
}

}  // namespace
}  // namespace bess::trial
