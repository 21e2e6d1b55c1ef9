// Rare faults that the counters forgive are found by the energy that they move, at any rhythm: the
// bound of edge/core/supervision/energy_balance.h.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "tests/system/trial/trial_run.h"

namespace bess::trial {
namespace {

/// At every second to tenth tick, and at random ones.
std::vector<FaultTimes> rhythms() {
  std::vector<FaultTimes> all;
  for (int every = 2; every <= 10; ++every) all.push_back({.every = every});
  for (const double share : {0.05, 0.1, 0.2, 0.3}) all.push_back({.probability = share});
  return all;
}
constexpr const char* kRareFaults[] = {"inverted", "inverted_charge", "inverted_discharge", "twice",
                                       "excess_2_kw"};
constexpr Orders kRareOrders[] = {Orders::kAlternating, Orders::kPairs, Orders::kHours,
                                  Orders::kRealDay};
constexpr int kRareDays = 10;
constexpr double kCapacityWh = BatteryNature{}.capacity_wh;

double percent_of_capacity(double energy_wh) { return 100 * energy_wh / kCapacityWh; }

std::string say_rare(const FaultResult& r) {
  char text[120];
  const bool is_found = r.reason != Reason::kStudent;
  std::snprintf(text, sizeof text, "%s%.1f %% after %.1f h, reported %.1f %%", is_found ? "" : "- ",
                percent_of_capacity(r.wrong_wh), r.cycles / 30.0,
                percent_of_capacity(r.wrong_until_reported_wh));
  return text;
}

constexpr double kFoundPercent = WrongEnergy::kFoundE6 / 1e4;
constexpr double kReportedPercent = WrongEnergy::kReportedE6 / 1e4;

class RareFault : public ::testing::TestWithParam<const char*> {};

TEST_P(RareFault, IsReportedAndTripsBeforeTwiceTheBound) {
  for (const FaultTimes& times : rhythms()) {
    for (const Orders orders : kRareOrders) {
      for (const double soc_frac : {0.15, 0.45, 0.85}) {
        const FaultResult r = try_fault({.fault = &trial_fault(GetParam()),
                                         .times = times,
                                         .orders = orders,
                                         .soc_frac = soc_frac,
                                         .cycles_max = kRareDays * kStepsPerDay});
        if (r.wrong_wh == 0) continue;  // no order showed the fault
        SCOPED_TRACE("every " + std::to_string(times.every) + ", at random " +
                     std::to_string(times.probability) + ", " + std::string(orders_name(orders)) +
                     ", from " + std::to_string(soc_frac) + ": " + say_rare(r));
        EXPECT_TRUE(r.is_trip) << reason_name(r.reason);
        EXPECT_EQ(r.driven_after, 0);
        EXPECT_LT(percent_of_capacity(r.wrong_wh), 2 * kFoundPercent);
        const bool is_reported = r.wrong_until_reported_wh > 0;
        const double until_reported_wh = is_reported ? r.wrong_until_reported_wh : r.wrong_wh;
        EXPECT_LT(percent_of_capacity(until_reported_wh), 2 * kReportedPercent);
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
