// Every shipped map through the real driver: the registers of charge, idle, discharge and release,
// one by one, as the maps' sources give them; signs; what release restores. SunSpec:
// sunspec_maps_test.
#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "tests/support/register_device.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(ShippedMaps, EveryMapLoadsAndIsListedForTheTests) {
  std::set<std::string> listed;
  for (const MapVariant& variant : kShippedMapVariants) listed.insert(variant.map);
  std::set<std::string> shipped;
  for (const auto& file :
       std::filesystem::directory_iterator(BESS_SOURCE_DIR "/edge/device/maps")) {
    if (file.path().extension() != ".toml") continue;
    load_good_map(file.path().string());
    shipped.insert(file.path().stem().string());
  }
  EXPECT_EQ(listed, shipped);
}

TEST(AlphaEssDriver, OneBlockAndItsRelease) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  t.device.set(0x0126, {0xFA24});  // -1500: charging
  EXPECT_EQ(t.reading().soc_e4, 4'350);
  EXPECT_EQ(t.measured.power_w, 1'500);
  EXPECT_EQ(t.measured.charge_w_max, 4'000);
  EXPECT_EQ(t.measured.discharge_w_max, 3'500);
  EXPECT_FALSE(t.measured.dispatch_active);
  EXPECT_THAT(t.writes_of(4'000),
              ElementsAre(fc16(0x0880, {1, 0, 28'000, 0, 32'000, 2, 225, 0, 300, 255, 0}, 85)));
  EXPECT_TRUE(t.reading().dispatch_active);
  EXPECT_TRUE(t.measured.has_order_power);
  EXPECT_EQ(t.measured.order_power_w, 4'000);
  EXPECT_THAT(t.writes_of(-3'500),
              ElementsAre(fc16(0x0880, {1, 0, 35'500, 0, 32'000, 2, 25, 0, 300, 255, 0}, 85)));
  EXPECT_THAT(t.release_writes(),
              ElementsAre(fc16(0x0880, {0, 0, 32'000, 0, 32'000, 0, 0, 0, 90, 255, 0}, 85)));
  EXPECT_EQ(t.driver->refresh_interval_s(), 0);
}

TEST(FroniusGen24, ControlModeIsLastToStartAndFirstToStop) {
  MapUnderTest t(shipped_map("fronius_gen24"), fill_fronius);
  EXPECT_EQ(t.reading().soc_e4, 4'700);
  EXPECT_EQ(t.measured.power_w, 1'200);
  t.device.set(40'314, {0});
  t.device.set(40'334, {800});  // module 4 discharges
  EXPECT_EQ(t.reading().power_w, -800);
  // 40 % of 5000 W: -40.00 % as two's complement
  EXPECT_THAT(t.writes_of(2'000),
              ElementsAre(fc16(40'360, {1}), fc16(40'358, {300}), fc16(40'355, {61'536}),
                          fc16(40'356, {10'000}), fc16(40'348, {2})));
  EXPECT_EQ(t.reading().order_power_w, 2'000);
  EXPECT_THAT(t.writes_of(0), ElementsAre(fc16(40'358, {300}), fc16(40'355, {0}),
                                          fc16(40'356, {10'000}), fc16(40'348, {2})));
  // 25 %
  EXPECT_THAT(t.writes_of(-1'250), ElementsAre(fc16(40'358, {300}), fc16(40'355, {2'500}),
                                               fc16(40'356, {63'036}), fc16(40'348, {3})));
  EXPECT_EQ(t.reading().order_power_w, -1'250);
  EXPECT_THAT(t.release_writes(),
              ElementsAre(fc16(40'348, {0}), fc16(40'355, {10'000}), fc16(40'356, {10'000}),
                          fc16(40'358, {0}), fc16(40'360, {0})));
}

TEST(FroniusGen24, MoreThanTheInvertersRatingIsRefusedWithoutAWrite) {
  MapUnderTest t(shipped_map("fronius_gen24"), fill_fronius);
  EXPECT_EQ(t.order(5'001), Status::kNotExpressible);
  EXPECT_EQ(t.order(-5'001), Status::kNotExpressible);
  EXPECT_THAT(t.device.writes, IsEmpty());
}

TEST(FroniusGen24, FloatRegisterTypeIsTheWrongDevice) {
  MapUnderTest t(shipped_map("fronius_gen24"), fill_fronius);
  t.device.set(40'343, {0});
  EXPECT_EQ(t.read(), Status::kImplausible);
  EXPECT_EQ(t.order(1'000), Status::kImplausible);
  EXPECT_THAT(t.device.writes, IsEmpty());
}

TEST(HuaweiLuna2000, ForcibleIsLastAndFlashOnlyWhenItDiffers) {
  MapUnderTest t(shipped_map("huawei_luna2000"), fill_huawei);
  EXPECT_EQ(t.reading().power_w, -1'500);
  EXPECT_EQ(t.measured.soc_e4, 5'050);
  EXPECT_EQ(t.measured.capacity_wh, 10'000);
  EXPECT_EQ(t.measured.discharge_w_max, 4'500);
  // 47075 is the rated power already
  EXPECT_THAT(t.writes_of(4'000), ElementsAre(fc6(47'087, 1), fc16(47'247, {0, 4'000}),
                                              fc6(47'083, 2), fc6(47'246, 0), fc6(47'100, 1)));
  EXPECT_THAT(t.writes_of(0),
              ElementsAre(fc16(47'249, {0, 0}), fc6(47'083, 2), fc6(47'246, 0), fc6(47'100, 2)));
  EXPECT_THAT(t.writes_of(-3'000), ElementsAre(fc16(47'077, {0, 4'500}), fc16(47'249, {0, 3'000}),
                                               fc6(47'083, 2), fc6(47'246, 0), fc6(47'100, 2)));
  EXPECT_EQ(t.reading().order_power_w, -3'000);
  EXPECT_EQ(t.driver->counters().flash_writes_today, 2);
  EXPECT_THAT(t.release_writes(),
              ElementsAre(fc6(47'100, 0), fc16(47'077, {0, 2'500}), fc6(47'087, 0)));
}

TEST(HuaweiLuna2000, PowerIsCutToTheRatedOneAndRefreshedEvery30s) {
  MapUnderTest t(shipped_map("huawei_luna2000"), fill_huawei);
  EXPECT_EQ(t.driver->refresh_interval_s(), 30);
  ASSERT_EQ(t.order(9'000), Status::kOk);
  EXPECT_EQ(t.device.holding[47'248], 5'000);
  t.device.take_writes();
  t.device.pass_s(30);
  EXPECT_THAT(t.refresh_writes(), ElementsAre(fc16(47'247, {0, 5'000}), fc6(47'083, 2),
                                              fc6(47'246, 0), fc6(47'100, 1)));
}

TEST(HuaweiLuna2000, PermissionDeniedIsDistinguished) {
  MapUnderTest t(shipped_map("huawei_luna2000"), fill_huawei);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.exception = 0x80;
  EXPECT_EQ(t.order(1'000), Status::kNotPermitted);
  t.device.exception = 6;
  EXPECT_EQ(t.order(1'000), Status::kBusBusy);
  t.device.exception = 2;
  EXPECT_EQ(t.order(1'000), Status::kBusException);
}

TEST(VictronEss3, SetPointOfTheVebusDeviceAndEssModeOfTheSystem) {
  MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
  EXPECT_EQ(t.reading().power_w, 1'500);
  EXPECT_EQ(t.measured.soc_e4, 6'200);
  EXPECT_EQ(t.driver->refresh_interval_s(), 5);
  EXPECT_THAT(t.writes_of(4'000), ElementsAre(fc16(2'902, {3}, 100), fc16(37, {4'000, 0, 0}, 228)));
  EXPECT_THAT(t.writes_of(-3'000), ElementsAre(fc16(37, {62'536, 0, 0}, 228)));
  EXPECT_THAT(t.writes_of(0), ElementsAre(fc16(37, {0, 0, 0}, 228)));
  t.device.pass_s(29);
  EXPECT_THAT(t.refresh_writes(), ElementsAre(fc16(37, {0, 0, 0}, 228)));
  EXPECT_THAT(t.release_writes(), ElementsAre(fc16(37, {0}, 228), fc16(2'902, {1}, 100)));
}

TEST(VictronEss3, SixtySecondsWithoutARefreshIsNoOrderAnyMore) {
  MapUnderTest t(shipped_map("victron_ess3"));
  t.device.set(2'902, {2});
  ASSERT_EQ(t.order(1'000), Status::kOk);
  EXPECT_TRUE(t.reading().dispatch_active);
  t.device.pass_s(61);
  EXPECT_FALSE(t.reading().dispatch_active);
  t.device.take_writes();
  EXPECT_THAT(t.writes_of(1'000), ElementsAre(fc16(37, {1'000, 0, 0}, 228)));
}

/// Its set point has expired, but the mode stays: passthru until a later run releases it.
TEST(VictronEss3, AModeThatAKilledProcessLeftIsSeenByTheNext) {
  MapUnderTest t(shipped_map("victron_ess3"));
  t.device.set(843, {62});
  t.device.set(2'902, {3});
  EXPECT_TRUE(t.reading().dispatch_active);
  EXPECT_FALSE(t.measured.has_order_power);  // whether it is still in force is unknown
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.device.holding[2'902], 1);
  EXPECT_FALSE(t.reading().dispatch_active);
}

TEST(VictronEss3, ThreePhasesShareThePower) {
  MapUnderTest t(shipped_map("victron_ess3"), "three_phase");
  t.device.set(2'902, {3});
  EXPECT_THAT(t.writes_of(-4'000),
              ElementsAre(fc16(37, {64'203, 0, 0}, 228), fc16(40, {64'203, 64'203}, 228)));
  EXPECT_EQ(t.reading().order_power_w, -3'999);
}

TEST(SungrowSh, ExternalEmsWithHeartbeat) {
  MapUnderTest t(shipped_map("sungrow_sh"), fill_sungrow);
  EXPECT_THAT(t.writes_of(4'000),
              ElementsAre(fc6(13'079, 60), fc6(13'050, 0xCC), fc6(13'049, 3), fc6(13'079, 60),
                          fc6(13'051, 4'000), fc6(13'050, 0xAA)));
  t.device.pass_s(20);
  EXPECT_THAT(t.refresh_writes(), ElementsAre(fc6(13'079, 60)));
  EXPECT_THAT(t.writes_of(-3'000),
              ElementsAre(fc6(13'079, 60), fc6(13'051, 3'000), fc6(13'050, 0xBB)));
  EXPECT_EQ(t.reading().order_power_w, -3'000);
  EXPECT_THAT(t.writes_of(0), ElementsAre(fc6(13'079, 60), fc6(13'050, 0xCC)));
  EXPECT_THAT(t.release_writes(), ElementsAre(fc6(13'050, 0xCC), fc6(13'049, 0)));
}

TEST(SungrowSh, ForcedModeHasNoWatchdogAndIsNeverRefreshed) {
  MapUnderTest t(shipped_map("sungrow_sh"), "forced");
  fill_sungrow(t.device);
  EXPECT_THAT(t.writes_of(4'000), ElementsAre(fc6(13'050, 0xCC), fc6(13'049, 2), fc6(13'051, 4'000),
                                              fc6(13'050, 0xAA)));
  EXPECT_EQ(t.driver->refresh_interval_s(), 0);
  t.device.pass_s(3'600);
  ASSERT_EQ(t.driver->refresh(), Status::kOk);
  EXPECT_THAT(t.writes_of(4'000), IsEmpty());
}

TEST(Sma, SixOrderedWrites) {
  MapUnderTest t(shipped_map("sma"), "bms_mode");
  const auto write = [](int address, int value) { return fc16(address, {0, value}, 3); };
  t.device.set(30'845, {0, 55});
  t.device.set_input(31'393, {0, 1'200, 0, 0});
  t.device.set(40'236, {0, 2'424});
  t.device.set(40'795, {0, 4'600});
  t.device.set(40'799, {0xFFFF, 0xFFFF});  // not implemented: must not be written back
  EXPECT_EQ(t.reading().soc_e4, 5'500);
  EXPECT_EQ(t.measured.power_w, 1'200);
  EXPECT_THAT(t.writes_of(4'000),
              ElementsAre(write(40'236, 2'289), write(40'793, 4'000), write(40'795, 4'000),
                          write(40'797, 0), write(40'799, 0), write(40'801, 0)));
  EXPECT_THAT(t.writes_of(-3'000),
              ElementsAre(write(40'236, 2'290), write(40'793, 0), write(40'795, 0),
                          write(40'797, 3'000), write(40'799, 3'000), write(40'801, 0)));
  EXPECT_THAT(t.writes_of(0), ElementsAre(write(40'236, 2'424), write(40'793, 0), write(40'795, 0),
                                          write(40'797, 0), write(40'799, 0), write(40'801, 0)));
  EXPECT_THAT(t.release_writes(),
              ElementsAre(write(40'236, 2'424), write(40'793, 0), write(40'795, 4'600),
                          write(40'797, 0), write(40'799, 4'200), write(40'801, 0)));
}

/// Limits ordered by a killed process must not be taken for the original ones.
TEST(Sma, ARestartDoesNotSaveTheOrderOfThePreviousRun) {
  MapUnderTest t(shipped_map("sma"), "bms_mode");
  t.device.set(30'845, {0, 55});
  t.device.set(40'236, {0, 2'424});
  t.device.set(40'795, {0, 4'600});
  t.device.set(40'799, {0, 4'600});
  for (const std::int32_t power_w : {4'000, -4'000}) {
    ASSERT_EQ(t.read(), Status::kOk);
    ASSERT_EQ(t.order(power_w), Status::kOk);
    DeviceDriver successor(t.map, DeviceClock(t.device), -1, t.device);
    ASSERT_EQ(successor.read(t.measured), Status::kOk);
    ASSERT_EQ(successor.order({.power_w = 0, .duration_s = 60}), Status::kOk);
    ASSERT_EQ(successor.release(), Status::kOk);
    EXPECT_EQ(t.device.holding[40'796], 4'200) << power_w;
    EXPECT_EQ(t.device.holding[40'800], 4'200) << power_w;
  }
}

TEST(Sma, SetPointPositiveIsDischarge) {
  MapUnderTest t(shipped_map("sma"), "setpoint");
  t.device.set(30'845, {0, 55});
  ASSERT_EQ(t.order(4'000), Status::kOk);
  ASSERT_EQ(t.order(-3'000), Status::kOk);
  EXPECT_THAT(t.release_writes(),
              ElementsAre(fc16(40'149, {0xFFFF, 0xF060}, 3), fc16(40'151, {0, 802}, 3),
                          fc16(40'149, {0, 3'000}, 3), fc16(40'151, {0, 802}, 3),
                          fc16(40'149, {0, 0}, 3), fc16(40'151, {0, 803}, 3)));
}

TEST(Simulator, OneBlockInOurOwnUnits) {
  MapUnderTest t(shipped_map("simulator"));
  t.device.set(0, {'b' << 8 | 'e', 's' << 8 | 's', '-' << 8 | 's', 'i' << 8 | 'm'});
  t.device.set(10, {5'000, 0, 0, 0, 8'000});
  t.device.set(22, {1});
  ASSERT_EQ(t.order(4'000), Status::kOk);
  ASSERT_EQ(t.order(-4'000), Status::kOk);
  EXPECT_THAT(t.release_writes(),
              ElementsAre(fc16(100, {1, 0, 4'000, 9'000, 0, 300}),
                          fc16(100, {1, 0xFFFF, 0xF060, 1'000, 0, 300}), fc16(100, {0, 0, 0})));
  t.device.set(0, {'b' << 8 | 'a'});
  MapUnderTest other(shipped_map("simulator"));
  EXPECT_EQ(other.read(), Status::kImplausible);
}

}  // namespace
}  // namespace bess
