// Unhealthy devices on every shipped map: raw extremes are no values, every alarm and every warning
// is seen, and registers that a model lacks are optional.
#include <gtest/gtest.h>

#include "tests/support/image_device.h"

namespace bess {
namespace {

/// The simulated battery of a map, with some fixed registers.
class HeldDevice {
 public:
  explicit HeldDevice(const MapVariant& wanted)
      : simulated_(wanted.map, wanted.variant), well_(wanted.map, wanted.variant) {
    device().before_request = [this] {
      simulated_.image.refresh(simulated_.utc_ns());
      for (const Held& held : held_) write(held);
    };
  }
  [[nodiscard]] RegisterDevice& device() { return simulated_.test.device; }
  [[nodiscard]] const RegisterMap& map() const { return simulated_.test.map; }
  [[nodiscard]] const BatteryMeasurement& measured() const { return simulated_.test.measured; }
  Status read() { return simulated_.test.read(); }

  /// From the next request on the point's registers are `bits`.
  void hold(int point, std::uint64_t bits) { held_.push_back({point, bits}); }
  /// ... are what makes the condition true.
  void hold(const Condition& condition) {
    const RegisterPoint& p = map().points[condition.point];
    const bool is_any = condition.test == Condition::Test::kNotEqual;
    const auto value = static_cast<std::uint64_t>(is_any ? 1 : condition.value);
    hold(condition.point, value << (p.mask == 0 ? 0 : std::countr_zero(p.mask)));
  }
  void let_go() {
    for (Held& held : held_) held.bits = before(held.point);
    for (const Held& held : held_) write(held);
    held_.clear();
  }
  void lack(int point) {
    const RegisterPoint& p = map().points[point];
    for (int i = 0; i < p.registers; ++i) {
      device().missing.push_back(
          {.function = p.read_function, .address = simulated_.image.address_of(point) + i});
    }
  }
  [[nodiscard]] int address_of(int point) const { return simulated_.image.address_of(point); }

 private:
  struct Held {
    int point;
    std::uint64_t bits;
  };

  /// As at the start; measurements are rendered again anyway.
  [[nodiscard]] std::uint64_t before(int point) {
    const RegisterPoint& p = map().points[point];
    const auto& table = p.read_function == 4 ? well_.test.device.input : well_.test.device.holding;
    std::uint64_t bits = 0;
    for (int i = 0; i < p.registers; ++i) {
      const bool high_first = p.word_order == WordOrder::kHighFirst;
      const int word = high_first ? i : p.registers - 1 - i;
      bits = bits << 16 | table[static_cast<std::size_t>(address_of(point) + word)];
    }
    return bits;
  }
  void write(const Held& held) {
    const RegisterPoint& p = map().points[held.point];
    auto& table = p.read_function == 4 ? device().input : device().holding;
    for (int i = 0; i < p.registers; ++i) {
      const bool high_first = p.word_order == WordOrder::kHighFirst;
      const int word = high_first ? p.registers - 1 - i : i;
      table[static_cast<std::size_t>(address_of(held.point) + i)] =
          static_cast<std::uint16_t>(held.bits >> 16 * word);
    }
  }

  SimulatedDevice simulated_;
  SimulatedDevice well_;  ///< it never had a value
  std::vector<Held> held_;
};

class EveryMapState : public ::testing::TestWithParam<MapVariant> {};

std::vector<std::uint64_t> raw_extremes(RegisterType type) {
  switch (type) {
    case RegisterType::kU16:
      return {0xFFFF};
    case RegisterType::kS16:
      return {0x8000};
    case RegisterType::kU32:
      return {0xFFFF'FFFF};
    case RegisterType::kS32:
      return {0x8000'0000};
    default:
      return {};
  }
}

/// SoC, powers, capacity, limits, temperatures, and the required parts of alarms.
TEST_P(EveryMapState, RawExtremesAreNoValues) {
  int refused = 0;
  for (const std::int8_t point : load_shipped_map(GetParam()).required) {
    HeldDevice device(GetParam());
    const RegisterPoint& p = device.map().points[point];
    // Of a part of a register, such as a sign, every value is one.
    std::vector<std::uint64_t> extremes;
    if (p.mask == RegisterPoint{}.mask) extremes = raw_extremes(p.type);
    for (const std::uint64_t nothing : p.not_implemented) extremes.push_back(nothing);
    for (const std::uint64_t bits : extremes) {
      ASSERT_EQ(device.read(), Status::kOk) << p.name.view();
      device.hold(point, bits);
      device.device().pass_s(p.max_age_s + 1);
      EXPECT_EQ(device.read(), Status::kImplausible) << p.name.view() << " " << bits;
      device.let_go();
      device.device().pass_s(p.max_age_s + 1);
      ++refused;
    }
  }
  EXPECT_GE(refused, 2) << "SoC and power at least";
}

TEST_P(EveryMapState, EveryAlarmStopsAndEveryWarningIsReported) {
  HeldDevice device(GetParam());
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_FALSE(device.measured().alarm);
  EXPECT_FALSE(device.measured().warning);
  EXPECT_FALSE(device.measured().off_grid);
  EXPECT_FALSE(device.map().alarms.empty());
  for (const Condition& alarm : device.map().alarms) {
    device.hold(alarm);
    ASSERT_EQ(device.read(), Status::kOk);
    EXPECT_TRUE(device.measured().alarm) << device.map().points[alarm.point].name.view();
    device.let_go();
  }
  for (const Condition& warning : device.map().warnings) {
    device.hold(warning);
    ASSERT_EQ(device.read(), Status::kOk);
    EXPECT_TRUE(device.measured().warning) << device.map().points[warning.point].name.view();
    EXPECT_FALSE(device.measured().alarm) << device.map().points[warning.point].name.view();
    device.let_go();
  }
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_FALSE(device.measured().alarm);
  EXPECT_FALSE(device.measured().warning);
}

/// An alarm orders 0 W for five minutes; off-grid, the house needs its battery immediately.
TEST_P(EveryMapState, OffGridIsStrongerThanTheFaultsThatComeWithIt) {
  HeldDevice device(GetParam());
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_FALSE(device.measured().off_grid);
  if (device.map().off_grid.point < 0) return;  // this map cannot show it
  const auto other =
      std::find_if(device.map().alarms.begin(), device.map().alarms.end(),
                   [&](const Condition& c) { return c.point != device.map().off_grid.point; });
  ASSERT_NE(other, device.map().alarms.end());
  device.hold(*other);
  device.hold(device.map().off_grid);
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_TRUE(device.measured().off_grid);
  EXPECT_FALSE(device.measured().alarm);
  EXPECT_TRUE(device.measured().warning);
}

TEST_P(EveryMapState, WhatAModelLacksIsDoneWithout) {
  HeldDevice device(GetParam());
  int optional = 0;
  for (int i = 0; i < device.map().points.size(); ++i) {
    const auto& required = device.map().required;  // some of them report the power
    const bool is_required = std::find(required.begin(), required.end(), i) != required.end();
    if (!device.map().points[i].optional || is_required) continue;
    device.lack(i);
    ++optional;
  }
  ASSERT_EQ(device.read(), Status::kOk);
  if (optional == 0) return;  // every device has all of it
  EXPECT_FALSE(device.measured().alarm);
  const int refused = device.device().refused_reads;
  EXPECT_GE(refused, 1);
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_EQ(device.device().refused_reads, refused) << "asked for once";
  device.device().pass_s(601);  // with the identity, in case it was not ready
  ASSERT_EQ(device.read(), Status::kOk);
  EXPECT_GT(device.device().refused_reads, refused);
}

/// A single refused register must not affect its neighbours.
TEST_P(EveryMapState, PresentRegistersAreReadNextToMissingOnes) {
  const RegisterMap map = load_shipped_map(GetParam());
  for (int lacking = 0; lacking < map.points.size(); ++lacking) {
    if (!map.points[lacking].optional) continue;
    for (const Condition& alarm : map.alarms) {
      HeldDevice device(GetParam());
      const int first = device.address_of(lacking);
      const int begin = device.address_of(alarm.point);
      const bool is_apart = begin + map.points[alarm.point].registers <= first ||
                            first + map.points[lacking].registers <= begin;
      if (!is_apart) continue;
      device.lack(lacking);
      device.hold(alarm);
      ASSERT_EQ(device.read(), Status::kOk) << map.points[lacking].name.view();
      EXPECT_TRUE(device.measured().alarm)
          << map.points[alarm.point].name.view() << " without " << map.points[lacking].name.view();
      break;
    }
  }
  EXPECT_FALSE(map.alarms.empty());
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapState, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
