// Every shipped map over real Modbus TCP: the edge's own framing and driver against libmodbus'
// frames and the simulated device, orders read back and followed, the device released.
#include <gtest/gtest.h>

#include "edge/device/battery/modbus_battery.h"
#include "tests/unit/tools/loopback_battery.h"

namespace bess {
namespace {

class EveryMapOnTheWire : public ::testing::TestWithParam<MapVariant> {};

TEST_P(EveryMapOnTheWire, OrdersAreObeyedReadBackAndReleased) {
  constexpr std::int32_t kTimeScale = 20;  // 60 s of the shortest watchdog take 3 s
  LoopbackBattery loopback(load_shipped_map(GetParam()), {}, Transport::kTcp,
                           LoopbackBattery::kHouse, kTimeScale);
  ModbusBattery battery(loopback.link(2'000), loopback.map, loopback.clock);
  IdentityFailure failure;
  ASSERT_EQ(battery.check_identity(failure), Status::kOk) << failure.check << " " << failure.value;
  BatteryMeasurement m;
  for (const std::int32_t power_w : {4'000, 0, -4'000}) {
    ASSERT_EQ(battery.order({.power_w = power_w,
                             .soc_min_e4 = 1'000,
                             .soc_max_e4 = 10'000,
                             .duration_s = loopback.map.watchdog.duration_s}),
              Status::kOk)
        << power_w;
    ASSERT_EQ(battery.read(m), Status::kOk);
    EXPECT_NEAR(m.power_w, power_w, 2);
    EXPECT_TRUE(m.dispatch_active);
  }
  ASSERT_EQ(battery.release(), Status::kOk);
  ASSERT_EQ(battery.read(m), Status::kOk);
  EXPECT_EQ(m.power_w, 0);
  EXPECT_FALSE(m.dispatch_active);
  EXPECT_EQ(battery.counters().failed_requests, 0);
  EXPECT_EQ(battery.counters().reconnects, 0);
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapOnTheWire, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
