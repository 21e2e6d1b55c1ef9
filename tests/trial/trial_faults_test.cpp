// How soon each fault of the trial is found, by how often it strikes and what is ordered meanwhile.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/trial/trial_run.h"

namespace bess::trial {
namespace {

constexpr unsigned kAtCharge = 1;
constexpr unsigned kAtDischarge = 2;
constexpr unsigned kAtZero = 4;
constexpr unsigned kAtBoth = kAtCharge | kAtDischarge;

/// A fault whose power is shown, and the orders at which it differs from the order.
struct ShownFault {
  const char* name;
  unsigned at;
  friend void PrintTo(const ShownFault& f, std::ostream* out) { *out << f.name; }
};

constexpr ShownFault kShownFaults[] = {
    {"inverted", kAtBoth},
    {"inverted_discharge", kAtDischarge},
    {"inverted_charge", kAtCharge},
    {"only_discharges", kAtCharge},
    {"only_charges", kAtDischarge},
    {"twice", kAtBoth},
    {"half_again", kAtBoth},
    {"excess_2_kw", kAtBoth},
    {"dead", kAtBoth},
    {"one_order_late", kAtBoth | kAtZero},
    {"ends_after_30_s", kAtBoth},
    {"idle_discharge_3_kw", kAtZero},
    {"idle_charge_3_kw", kAtZero},
    {"power_inverted", kAtBoth},
    {"power_a_tenth", kAtBoth},
    {"power_ten_times", kAtBoth},
};

unsigned at(Orders orders) {
  return orders == Orders::kCharge ? kAtCharge : orders == Orders::kZero ? kAtZero : kAtDischarge;
}

std::string say(const FaultResult& r) {
  return std::string(reason_name(r.reason)) + " after " + std::to_string(r.cycles) + " cycles";
}

class ShownFaultOfTheTrial : public ::testing::TestWithParam<ShownFault> {
 protected:
  static FaultResult result_of(int every, Orders orders) {
    return try_fault(
        {.fault = &trial_fault(GetParam().name), .times = {.every = every}, .orders = orders});
  }
  /// Stopped for a reason of the battery's, and not driven on.
  static void expect_found(int every, Orders orders, int cycles_max) {
    const FaultResult r = result_of(every, orders);
    SCOPED_TRACE(std::string(orders_name(orders)) + ", every " + std::to_string(every) + ": " +
                 say(r));
    EXPECT_NE(r.reason, Reason::kStudent);
    EXPECT_LE(r.cycles, cycles_max);
    if (r.is_trip) {
      EXPECT_EQ(r.driven_after, 0);
    } else {
      EXPECT_LE(r.driven_after, kCyclesAfter / 2);  // tried again, less and less often
    }
  }
  static void expect_found_with_constant_orders(int every, int cycles_max) {
    for (const Orders orders : {Orders::kCharge, Orders::kDischarge, Orders::kZero}) {
      if ((GetParam().at & at(orders)) != 0) expect_found(every, orders, cycles_max);
    }
  }
};

TEST_P(ShownFaultOfTheTrial, IsFoundInThreeCyclesWhereItIsConstant) {
  expect_found_with_constant_orders(1, 3);
}

std::string fault_name(const ::testing::TestParamInfo<ShownFault>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Faults, ShownFaultOfTheTrial, ::testing::ValuesIn(kShownFaults),
                         fault_name);

TEST(TrialFaults, AreAtLeastThirtyFive) { EXPECT_GE(trial_faults().size(), 35U); }

}  // namespace
}  // namespace bess::trial
