// Bus faults over TCP and over a serial line: each ends in a correct answer or in an error, never
// in the use of a wrong value. First the link alone with random reads and writes, then the battery
// driver with orders. The faults come at random from a fixed seed, so that they affect every kind
// of request.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

#include "edge/device/battery/modbus_battery.h"
#include "tests/unit/tools/loopback_battery.h"

namespace bess {
namespace {

struct Trouble {
  Transport transport;
  BatteryFault fault;
  std::int32_t late_ms = 60;  ///< after the time-out, within the quiet time that follows
  std::int32_t exception_code = 6;
};

constexpr std::int32_t kResponseTimeoutMs = 40;

BatteryServerSettings troubled(const Trouble& trouble, double probability) {
  BatteryServerSettings settings;
  settings.faults = {.faults = {trouble.fault}, .probability = probability, .seed = 7};
  if (trouble.fault == BatteryFault::kRefuse) {  // an open connection must be closed to be refused
    settings.faults.faults.push_back(BatteryFault::kDrop);
  }
  settings.faults.late_ms = trouble.late_ms;
  settings.faults.drip_ms = 1;
  settings.faults.exception_code = trouble.exception_code;
  return settings;
}

std::vector<Trouble> all_troubles() {
  std::vector<Trouble> troubles;
  for (const Transport transport : {Transport::kTcp, Transport::kRtu}) {
    for (const BatteryFaultInfo& info : battery_faults()) {
      const bool has = transport == Transport::kTcp ? info.tcp : info.rtu;
      // The rest are faults of the battery, not of the bus: simulated_battery_test.
      if (has && info.fault <= BatteryFault::kAckWithoutEffect) {
        troubles.push_back({.transport = transport, .fault = info.fault});
      }
    }
    // Later than the quiet time: the reply arrives during the next request.
    troubles.push_back({.transport = transport, .fault = BatteryFault::kLate, .late_ms = 110});
    for (const int code : {1, 2, 3, 4, 0x80}) {
      troubles.push_back(
          {.transport = transport, .fault = BatteryFault::kException, .exception_code = code});
    }
  }
  return troubles;
}

std::string trouble_name(const ::testing::TestParamInfo<Trouble>& info) {
  const Trouble& trouble = info.param;
  std::string name = trouble.transport == Transport::kTcp ? "tcp_" : "rtu_";
  for (const BatteryFaultInfo& fault : battery_faults()) {
    if (fault.fault == trouble.fault) name += fault.name;
  }
  std::replace(name.begin(), name.end(), '-', '_');
  if (trouble.fault == BatteryFault::kLate) name += std::to_string(trouble.late_ms);
  if (trouble.fault == BatteryFault::kException) name += std::to_string(trouble.exception_code);
  return name;
}

/// Recovery time of a randomly disturbed link on a busy machine.
class Patience {
 public:
  /// False when the time is over; otherwise waits a moment.
  [[nodiscard]] bool lasts() const {
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 1'000);
    return clock_ns(CLOCK_MONOTONIC) < end_ns_;
  }

 private:
  std::int64_t end_ns_ = clock_ns(CLOCK_MONOTONIC) + 30 * kNanosecondsPerSecond;
};

class EveryFault : public ::testing::TestWithParam<Trouble> {};

/// Free registers of the simulated battery, and their possible values: one, or, after a write that
/// reported an error, also the old one.
class Scratch {
 public:
  static constexpr int kFirst = 0x0300;
  static constexpr int kCount = 8;

  void wrote(int address, std::uint16_t value, bool surely) {
    std::set<std::uint16_t>& possible = values_[address];
    if (possible.empty()) possible.insert(0);
    if (surely) possible.clear();
    possible.insert(value);
  }
  void expect(int address, std::uint16_t value) const {
    const auto found = values_.find(address);
    const bool possible = found == values_.end() ? value == 0 : found->second.contains(value);
    EXPECT_TRUE(possible) << "register " << address << " read " << value;
  }

 private:
  std::map<int, std::set<std::uint16_t>> values_;
};

/// One random request; true if it succeeded.
bool exchange(ModbusLink& link, Scratch& scratch, std::mt19937& random, std::uint16_t value) {
  const int count = 1 + static_cast<int>(random() % 3);
  const int address =
      Scratch::kFirst + static_cast<int>(random() % (Scratch::kCount + 1 - std::size_t(count)));
  std::uint16_t registers[3] = {};
  if (random() % 2 == 0) {
    const RegisterSpan span{.unit = 85,
                            .address = static_cast<std::uint16_t>(address),
                            .count = static_cast<std::uint16_t>(count)};
    if (link.read(span, registers) != Status::kOk) return false;
    for (int i = 0; i < count; ++i) scratch.expect(address + i, registers[i]);
    return true;
  }
  for (int i = 0; i < count; ++i) registers[i] = static_cast<std::uint16_t>(value + i);
  const std::uint8_t function = count == 1 ? 6 : 16;
  const bool written = link.write(85, function, static_cast<std::uint16_t>(address), registers,
                                  count) == Status::kOk;
  // Acknowledgement without effect is the only fault that requires a read-back.
  for (int i = 0; i < count; ++i) scratch.wrote(address + i, registers[i], written);
  return written;
}

TEST_P(EveryFault, ALinkNeverReturnsAnotherRegistersValue) {
  if (GetParam().fault == BatteryFault::kAckWithoutEffect) {
    GTEST_SKIP() << "a link cannot know, an order reads back: the next test";
  }
  LoopbackBattery loopback("block", troubled(GetParam(), 0.35), GetParam().transport);
  ModbusLink link(loopback.link(kResponseTimeoutMs), {}, loopback.clock);
  Scratch scratch;
  std::mt19937 random(11);
  const Patience patience;
  int good = 0;
  int all = 0;
  for (; all < 30 || (good < 5 && patience.lasts()); ++all) {
    if (exchange(link, scratch, random, static_cast<std::uint16_t>(1'000 + 10 * all))) ++good;
  }
  EXPECT_GE(good, 5);  // it always recovers
  // The fault occurred; a repeated reply is skipped, and a slow one may be in time.
  if (GetParam().fault != BatteryFault::kDuplicate && GetParam().fault != BatteryFault::kDrip) {
    EXPECT_LT(good, all);
  }
  EXPECT_EQ(link.counters().requests, all);
  EXPECT_EQ(link.counters().failed_requests, all - good);
}

void expect_truth(const BatteryMeasurement& m, const std::set<std::int32_t>& in_force) {
  EXPECT_TRUE(in_force.contains(m.power_w)) << m.power_w;
  EXPECT_EQ(m.capacity_wh, 800'000);
  EXPECT_EQ(m.soc_e4, 5'000);
  EXPECT_EQ(m.charge_w_max, 4'000);
  EXPECT_EQ(m.discharge_w_max, 4'000);
  EXPECT_EQ(m.temperature_max_deci_c, 200);
  EXPECT_FALSE(m.alarm || m.off_grid);
}

/// Orders through one variant of the map; each has a distinct power.
void order_in_trouble(const Trouble& trouble, const char* variant) {
  SCOPED_TRACE(variant);
  // So large that the state of charge does not change.
  constexpr BatteryParameters kLarge{.power_w_max = 4'000, .capacity_wh = 800'000};
  // The device's watchdog must outlast lost replies on a busy machine: 300 s are 3 s.
  constexpr std::int32_t kScale = 100;
  LoopbackBattery loopback(load_shipped_map({"alphaess", variant}), troubled(trouble, 0.15),
                           trouble.transport, kLarge, kScale);
  ModbusBattery battery(loopback.link(kResponseTimeoutMs), loopback.map, loopback.clock);
  // Of an order whose start alone had no effect, after a start at 0 W, every register reads as
  // written: only its power shows that (ResponseMonitor).
  const bool starts_late = trouble.fault == BatteryFault::kAckWithoutEffect;
  std::set<std::int32_t> in_force = {0};
  PowerOrder order{.soc_min_e4 = 1'000, .duration_s = 86'400};
  Status ordered = Status::kNotConnected;
  const Patience patience;
  for (int i = 0; i < 6 || (ordered != Status::kOk && patience.lasts()); ++i) {
    order.power_w = i % 2 == 0 ? 100 + i % 3'000 : -100 - i % 3'000;
    ordered = battery.order(order);
    if (ordered == Status::kOk) {
      in_force = {order.power_w};
      if (starts_late) in_force.insert(0);
    } else {
      in_force.insert({0, order.power_w});  // neither, accepted, or withdrawn
    }
    BatteryMeasurement m;
    if (battery.read(m) != Status::kOk || m.lost_point != 0) continue;
    expect_truth(m, in_force);
    EXPECT_TRUE(m.dispatch_active || ordered != Status::kOk);
  }
  ASSERT_EQ(ordered, Status::kOk);  // it always recovers
  const SimulatedBattery& truth = loopback.stop();
  EXPECT_TRUE(truth.dispatch_active());
  EXPECT_TRUE(truth.power_w() == order.power_w || (starts_late && truth.power_w() == 0));
}

TEST_P(EveryFault, WhatReadSaysIsTrueAndWhatOrderSaysIsInForce) {
  order_in_trouble(GetParam(), "block");
  order_in_trouble(GetParam(), "five_writes");
}

INSTANTIATE_TEST_SUITE_P(Bus, EveryFault, ::testing::ValuesIn(all_troubles()), trouble_name);

struct Verdict {
  BatteryFault fault;
  bool write;
  Status tcp, rtu;
};

/// Status of a fault at every request; kOk where this bus lacks the fault.
TEST(ModbusFaults, EachIsReportedByItsStatus) {
  constexpr Status kNone = Status::kOk;
  const Verdict verdicts[] = {
      {BatteryFault::kSilence, false, Status::kTimeout, Status::kTimeout},
      {BatteryFault::kLate, false, Status::kTimeout, Status::kTimeout},
      {BatteryFault::kException, false, Status::kBusBusy, Status::kBusBusy},
      {BatteryFault::kDrop, false, Status::kNotConnected, kNone},
      {BatteryFault::kReset, false, Status::kNotConnected, kNone},
      {BatteryFault::kHalfOpen, false, Status::kTimeout, kNone},
      {BatteryFault::kRefuse, false, Status::kNotConnected, kNone},
      {BatteryFault::kTruncated, false, Status::kTimeout, Status::kTimeout},
      {BatteryFault::kByteGap, false, Status::kTimeout, Status::kTimeout},
      {BatteryFault::kWrongTransaction, false, Status::kTimeout, kNone},
      {BatteryFault::kWrongProtocol, false, Status::kBadReply, kNone},
      {BatteryFault::kWrongUnit, false, Status::kBadReply, Status::kBadReply},
      {BatteryFault::kWrongFunction, false, Status::kBadReply, Status::kBadReply},
      {BatteryFault::kFewerRegisters, false, Status::kBadReply, Status::kTimeout},
      {BatteryFault::kBadCrc, false, kNone, Status::kBadReply},
      {BatteryFault::kWrongAddress, true, Status::kBadReply, Status::kBadReply},
      {BatteryFault::kWrongValue, true, Status::kBadReply, Status::kBadReply},
  };
  constexpr std::uint16_t kValues[2] = {1, 2};
  for (const Verdict& verdict : verdicts) {
    for (const Transport transport : {Transport::kTcp, Transport::kRtu}) {
      const Status expected = transport == Transport::kTcp ? verdict.tcp : verdict.rtu;
      if (expected == kNone) continue;
      const std::int32_t timeout_ms = expected == Status::kTimeout ? kResponseTimeoutMs : 5'000;
      // Both kinds of echo; of a read only the first, a late answer may belong to the second.
      for (const int function : verdict.write ? std::vector{6, 16} : std::vector{3}) {
        LoopbackBattery loopback("block", troubled({transport, verdict.fault, 100}, 1), transport);
        ModbusLink link(loopback.link(timeout_ms), {}, loopback.clock);
        std::uint16_t registers[2] = {};
        const Status status =
            verdict.write
                ? link.write(85, static_cast<std::uint8_t>(function), Scratch::kFirst, kValues, 2)
                : link.read({.unit = 85, .address = 0x0102, .count = 2}, registers);
        EXPECT_EQ(status, expected)
            << status_name(status) << " instead of " << status_name(expected) << ", fault "
            << static_cast<int>(verdict.fault);
      }
    }
  }
}

/// A device that sends a byte now and then must not block the control thread.
TEST(ModbusFaults, ADrippingDeviceCannotHoldARequest) {
  for (const Transport transport : {Transport::kTcp, Transport::kRtu}) {
    BatteryServerSettings settings = troubled({transport, BatteryFault::kDrip}, 1);
    settings.faults.drip_ms = 30;  // 100 registers would take more than 6 s
    LoopbackBattery loopback("block", settings, transport);
    ModbusLink link(loopback.link(kResponseTimeoutMs), {}, loopback.clock);
    std::uint16_t registers[100] = {};
    const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
    EXPECT_EQ(link.read({.unit = 85, .address = 0x0102, .count = 100}, registers),
              Status::kTimeout);
    EXPECT_LT(clock_ns(CLOCK_MONOTONIC) - start_ns, 3 * kNanosecondsPerSecond);
  }
}

}  // namespace
}  // namespace bess
