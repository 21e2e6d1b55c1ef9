// What makers and other projects say of a device, against the maps: the facts here come from the
// sources that each test names, not from the map, so that a misreading cannot agree with itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/register_device.h"

namespace bess {
namespace {

/// Two's complement of 32 bits, low word first.
std::vector<int> low_first(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  return {static_cast<int>(bits & 0xFFFF), static_cast<int>(bits >> 16)};
}
int word(std::int32_t value) { return static_cast<std::uint16_t>(value); }

struct SungrowCase {
  const char* firmware;
  bool has_5213;
  int state_bits, power_5213, power_13021;
  std::int32_t power_w;
};

/// mkaiser modbus_sungrow.yaml (5213: negative = charging), evcc issues 17598 (new firmware: 13021
/// signed, charging bit set), 18838 and 18284 (13000 stays 0), openWB sungrow_sh (old firmware).
TEST(SungrowPower, HasItsSignOnEveryFirmware) {
  constexpr int kCharging = 0x2;
  constexpr int kDischarging = 0x4;
  const SungrowCase cases[] = {
      {"5213, charging", true, kCharging, -1'216, -1'216, 1'216},
      {"5213, discharging", true, kDischarging, 184, 184, -184},
      {"5213, state bits 0", true, 0, -3'000, -3'000, 3'000},
      {"5213, old 13021", true, kCharging, -900, 900, 900},
      {"signed 13021, charging", false, kCharging, 0, -1'216, 1'216},
      {"signed 13021, discharging", false, kDischarging, 0, 184, -184},
      {"signed 13021, state bits 0, charging", false, 0, 0, -700, 700},
      {"signed 13021, state bits 0, discharging", false, 0, 0, 184, -184},
      {"unsigned 13021, charging", false, kCharging, 0, 1'500, 1'500},
      {"unsigned 13021, discharging", false, kDischarging, 0, 1'500, -1'500},
      {"unsigned 13021, at rest", false, 0x1, 0, 0, 0},
  };
  for (const SungrowCase& c : cases) {
    MapUnderTest t(shipped_map("sungrow_sh"));
    t.device.set_input(12'999, {0x40, c.state_bits});
    t.device.set_input(13'021, {word(c.power_13021), 505});
    t.device.set_input(5'213, low_first(c.power_5213));
    t.device.set(33'046, {500, 450});
    if (!c.has_5213) t.device.missing = {{.function = 4, .address = 5'213}};
    ASSERT_EQ(t.read(), Status::kOk) << c.firmware;
    EXPECT_EQ(t.measured.power_w, c.power_w) << c.firmware;
    EXPECT_EQ(t.measured.lost_point, 0) << c.firmware;
  }
}

/// mkaiser issue 377: 13079 counts down from what was written, to 0, then the EMS mode is 0.
TEST(SungrowHeartbeat, CountsDownWithoutBeingTakenForAnotherMaster) {
  MapUnderTest t(shipped_map("sungrow_sh"));
  t.device.set_input(12'999, {0x40, 0});
  t.device.set_input(13'022, {505, 1'000, 215});
  t.device.set(33'046, {500, 450});
  std::int64_t written_ns = 0;
  int seconds = 0;
  t.device.after_write = [&](int address, int) {
    if (address != 13'079) return;
    seconds = t.device.holding[13'079];
    written_ns = t.device.now_ns;
  };
  t.device.before_request = [&] {
    t.device.now_ns += 300'000'000;  // a request takes its time
    const auto passed_s = static_cast<int>((t.device.now_ns - written_ns) / 1'000'000'000);
    t.device.set(13'079, {std::max(seconds - passed_s, 0)});
    if (seconds <= passed_s) t.device.set(13'049, {0});
  };
  ASSERT_EQ(t.order(2'000), Status::kOk);
  for (int i = 0; i < 30; ++i) {
    t.device.pass_s(t.driver->refresh_interval_s());
    ASSERT_EQ(t.driver->refresh(), Status::kOk) << i;
    ASSERT_EQ(t.read(), Status::kOk);
    EXPECT_FALSE(t.measured.order_replaced || t.measured.order_ended) << i;
    EXPECT_TRUE(t.measured.dispatch_active);
  }
}

}  // namespace
}  // namespace bess
