// Every shipped map over real Modbus TCP: the edge's own framing and driver against libmodbus' frames
// and the simulated device, orders read back and obeyed, the device released.
#include <gtest/gtest.h>

#include "edge/battery/modbus_battery.h"
#include "tests/tools/loopback_battery.h"

namespace bess {
namespace {

struct MapCase {
  const char* map;
  const char* variant;
  friend void PrintTo(const MapCase& c, std::ostream* out) { *out << c.map << " " << c.variant; }
};

RegisterMap load(const MapCase& c) {
  RegisterMap map;
  std::string error;
  const std::string path = std::string(BESS_SOURCE_DIR) + "/edge/maps/" + c.map + ".toml";
  EXPECT_TRUE(load_register_map(path, c.variant, map, error)) << error;
  return map;
}

class EveryMapOnTheWire : public ::testing::TestWithParam<MapCase> {};

TEST_P(EveryMapOnTheWire, OrdersAreObeyedReadBackAndReleased) {
  constexpr std::int32_t kTimeScale = 20;  // 60 s of the shortest watchdog take 3 s
  LoopbackBattery loopback(load(GetParam()), {}, Transport::kTcp, LoopbackBattery::kHouse,
                           kTimeScale);
  ModbusBattery battery(loopback.link(2'000), loopback.map, loopback.clock);
  IdentityFailure failure;
  ASSERT_EQ(battery.check_identity(failure), Status::kOk) << failure.check << " " << failure.value;
  BatteryMeasurement m;
  for (const std::int32_t power_w : {4'000, 0, -4'000}) {
    ASSERT_EQ(battery.order({.power_w = power_w,
                             .soc_min_e4 = 1'000,
                             .soc_max_e4 = 10'000,
                             .duration_s = loopback.map.dead_man_duration_s}),
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

constexpr MapCase kCases[] = {
    {"simulator", ""},     {"sunspec_124", ""},      {"sunspec_704", ""},
    {"fronius_gen24", ""}, {"victron_ess3", ""},     {"victron_ess3", "three_phase"},
    {"sungrow_sh", ""},    {"sungrow_sh", "forced"}, {"huawei_luna2000", ""},
    {"sma", ""},           {"sma", "setpoint"}};

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapOnTheWire, ::testing::ValuesIn(kCases));

}  // namespace
}  // namespace bess
