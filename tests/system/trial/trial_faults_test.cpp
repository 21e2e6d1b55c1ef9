// Detection time of each fault of the trial, by its frequency and the orders.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/system/trial/trial_run.h"

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
    {"power_in_kilowatts", kAtBoth},
    {"power_ten_times", kAtBoth},
};

unsigned at(Orders orders) {
  return orders == Orders::kCharge ? kAtCharge : orders == Orders::kZero ? kAtZero : kAtDischarge;
}

std::string say(const FaultResult& r) {
  return std::string(reason_name(r.reason)) + " after " + std::to_string(r.cycles) + " cycles";
}

/// Frequency of a fault, actions on the controller, and the number of control cycles within which
/// it is found with orders of one kind.
struct Way {
  const char* name;
  int cycles_max;
  int every = 1;
  bool is_killed = false;  ///< after each control cycle: each run sees one reading or two
  int step_every = 0;      ///< of its clock
};
constexpr Way kWays[] = {{"constant", 3},
                         {"every second tick", 6, 2},
                         {"every third tick", 9, 3},
                         {"killed", 6, 1, true},
                         {"clock stepped", 6, 1, false, 1},
                         {"killed, clock stepped", 9, 1, true, 1}};

class ShownFaultOfTheTrial : public ::testing::TestWithParam<ShownFault> {
 protected:
  /// Stopped for a reason of the battery, without a restart.
  static void expect_found(const Way& way, Orders orders, int cycles_max) {
    const FaultResult r = try_fault({.fault = &trial_fault(GetParam().name),
                                     .times = {.every = way.every},
                                     .orders = orders,
                                     .is_killed = way.is_killed,
                                     .step_every = way.step_every});
    SCOPED_TRACE(std::string(orders_name(orders)) + ", " + way.name + ": " + say(r));
    EXPECT_NE(r.reason, Reason::kStudent);
    EXPECT_LE(r.cycles, cycles_max);
    if (way.is_killed || way.step_every > 0) return;
    if (r.is_trip) {
      EXPECT_EQ(r.driven_after, 0);
    } else {
      EXPECT_LE(r.driven_after, kCyclesAfter * 3 / 4);  // retried, less and less often
    }
  }
};

TEST_P(ShownFaultOfTheTrial, IsFoundInEveryWay) {
  for (const Way& way : kWays) {
    for (const Orders orders : {Orders::kCharge, Orders::kDischarge, Orders::kZero}) {
      if ((GetParam().at & at(orders)) != 0) expect_found(way, orders, way.cycles_max);
    }
  }
}

TEST_P(ShownFaultOfTheTrial, IsFoundWithOrdersOfEitherSign) {
  if ((GetParam().at & kAtBoth) == 0) GTEST_SKIP() << "needs 0 W";
  const bool at_both = (GetParam().at & kAtBoth) == kAtBoth;
  expect_found(kWays[0], Orders::kAlternating, at_both ? 3 : 6);
  expect_found(kWays[0], Orders::kPairs, at_both ? 3 : 8);
}

INSTANTIATE_TEST_SUITE_P(Faults, ShownFaultOfTheTrial, ::testing::ValuesIn(kShownFaults),
                         [](const auto& info) { return std::string(info.param.name); });

/// A fault that only the SoC shows, and the control cycles at full power until it is found.
struct SocFault {
  const char* name;
  int cycles_max;
  bool is_reported =
      false;  ///< reported as a warning with the share that arrives: a wrong capacity, a bad meter
  friend void PrintTo(const SocFault& f, std::ostream* out) { *out << f.name; }
};

constexpr SocFault kSocFaults[] = {
    {"soc_frozen", 3},         {"all_frozen_but_echo", 3}, {"soc_inverted", 4},
    {"echo_dead", 4},          {"echo_inverted", 4},       {"soc_five_times", 4},
    {"echo_fifth", 20, true},  {"soc_a_fifth", 20, true},  {"echo_half", 20, true},
    {"half_hidden", 20, true}, {"soc_half", 20, true},     {"echo_twice", 20, true},
};

class SocFaultOfTheTrial : public ::testing::TestWithParam<SocFault> {
 protected:
  static void expect_found(Orders orders, double soc_frac, int cycles_max) {
    const FaultResult r =
        try_fault({.fault = &trial_fault(GetParam().name), .orders = orders, .soc_frac = soc_frac});
    SCOPED_TRACE(std::string(orders_name(orders)) + " from " + std::to_string(soc_frac) + ": " +
                 say(r));
    const bool is_reported = GetParam().is_reported && r.reported_cycles > 0;
    EXPECT_TRUE(is_reported || r.reason != Reason::kStudent);
    EXPECT_LE(is_reported ? r.reported_cycles : r.cycles, cycles_max);
  }
};

TEST_P(SocFaultOfTheTrial, IsFoundAtAnySocAtFullPower) {
  for (const double soc_frac : {0.09, 0.12, 0.45, 0.75})
    expect_found(Orders::kCharge, soc_frac, GetParam().cycles_max);
  for (const double soc_frac : {0.45, 0.85, 0.97})
    expect_found(Orders::kDischarge, soc_frac, GetParam().cycles_max);
}

TEST_P(SocFaultOfTheTrial, IsFoundWithOrdersOfEitherSign) {
  for (const Orders orders : {Orders::kAlternating, Orders::kPairs}) expect_found(orders, 0.45, 20);
}

INSTANTIATE_TEST_SUITE_P(Faults, SocFaultOfTheTrial, ::testing::ValuesIn(kSocFaults),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(TrialFaults, EnergyBeyondOrdersOfEitherSignIsReported) {
  for (const Orders orders : {Orders::kAlternating, Orders::kPairs}) {
    const FaultResult drained =
        try_fault({.fault = &trial_fault("hidden_drain_1_kw"), .orders = orders});
    EXPECT_GT(drained.reported_cycles, 0);
    EXPECT_LE(drained.reported_cycles, 20) << orders_name(orders);
    EXPECT_NEAR(drained.reported.rest_loss_w, 1'000, 200) << orders_name(orders);
    EXPECT_EQ(drained.reason, Reason::kStudent) << "reported, not stopped";
    const FaultResult creeping =
        try_fault({.fault = &trial_fault("soc_creeps_up"), .orders = orders});
    EXPECT_LE(creeping.reported_cycles, 15) << orders_name(orders);
    EXPECT_EQ(creeping.reason, Reason::kSocMismatch) << orders_name(orders);
    EXPECT_LE(creeping.cycles, 50) << orders_name(orders);
  }
}

/// Faults that nothing shows within two hours (notebook, 2026-11-23_limits_of_supervision.md).
constexpr std::string_view kUnseen[] = {"soc_at_least_9_percent", "limit_0_w_shown"};

TEST(TrialFaults, AllButTheKnownBlindSpotsAreFoundOrReported) {
  for (const TrialFault& fault : trial_faults()) {
    bool is_seen = false;
    for (const Orders orders : {Orders::kCharge, Orders::kDischarge, Orders::kZero,
                                Orders::kAlternating, Orders::kPairs}) {
      const FaultResult r = try_fault({.fault = &fault, .orders = orders});
      is_seen =
          is_seen || r.reason != Reason::kStudent || r.reported_cycles > 0 || r.weak_answers >= 2;
    }
    EXPECT_EQ(is_seen, std::ranges::find(kUnseen, fault.name) == std::end(kUnseen)) << fault.name;
  }
}

}  // namespace
}  // namespace bess::trial
