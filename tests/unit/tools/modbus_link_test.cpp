// Modbus driver of the edge against the simulated battery (libmodbus) on loopback: every command,
// and the distinction of errors. Faults: modbus_faults_test.
#include <gmock/gmock.h>

#include "edge/device/battery/modbus_battery.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tests/unit/tools/loopback_battery.h"

namespace bess {
namespace {

constexpr PowerOrder kChargeOrder{
    .power_w = 4'000, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 300};

TEST(ModbusLink, NoServerAndWrongUnitAreDistinguished) {
  BatteryLinkSettings link;
  {
    LoopbackBattery loopback("block");
    link = loopback.link();
    link.unit = 7;
    ModbusBattery wrong_unit(link, loopback.map, loopback.clock);
    BatteryMeasurement m;
    EXPECT_EQ(wrong_unit.read(m), Status::kTimeout);
  }
  const RegisterMap map = load_shipped_map({"alphaess", "block"});
  ModbusBattery nobody(link, map, ScaledClock{.scale = LoopbackBattery::kScale});
  BatteryMeasurement m;
  EXPECT_EQ(nobody.read(m), Status::kNotConnected);
}

TEST(ModbusLink, SecondClientIsRefusedUntilTheFirstIsGone) {
  LoopbackBattery loopback("block");
  BatteryMeasurement m;
  ModbusBattery second(loopback.link(2'000), loopback.map, loopback.clock);
  {
    ModbusBattery first(loopback.link(2'000), loopback.map, loopback.clock);
    ASSERT_EQ(first.read(m), Status::kOk);
    EXPECT_EQ(second.read(m), Status::kNotConnected);
    EXPECT_EQ(first.read(m), Status::kOk);
  }
  EXPECT_EQ(second.read(m), Status::kOk);
}

TEST(ModbusLink, IdentityOfTheSimulatedBatteryFits) {
  LoopbackBattery loopback("block");
  ModbusBattery battery(loopback.link(2'000), loopback.map, loopback.clock);
  IdentityFailure failure;
  EXPECT_EQ(battery.check_identity(failure), Status::kOk);
  loopback.map.identity[1].value_min = 9'000;  // a battery of at least 9 kWh was expected
  EXPECT_EQ(battery.check_identity(failure), Status::kImplausible);
  EXPECT_EQ(failure.check, 1);
  EXPECT_EQ(failure.value, 8'000);
  ModbusBattery stranger(loopback.link(2'000), loopback.map, loopback.clock);
  battery.close();
  BatteryMeasurement m;
  EXPECT_EQ(stranger.read(m), Status::kImplausible);  // never read, hence not driven
}

TEST(BatteryServer, PortInUseIsOneClearLine) {
  LoopbackBattery loopback("block");
  BatteryServerSettings settings;
  settings.port = loopback.link().port;
  SimulatedBattery other({.power_w_max = 4'000, .capacity_wh = 8'000}, 0.5, 0);
  EXPECT_THAT(user_error_of([&] { BatteryServer(settings, loopback.map, other, loopback.clock); }),
              Names(std::to_string(settings.port)));
}

}  // namespace
}  // namespace bess
