// Every shipped meter map through the real reader: the registers named by the sources, signs, and
// refusals. Also the batteries' own grid meters.
#include <gmock/gmock.h>

#include <bit>
#include <filesystem>

#include "edge/device/battery/modbus_battery.h"
#include "tests/support/register_device.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

struct MeterUnderTest {
  explicit MeterUnderTest(const std::string& name, const std::string& variant = "")
      : map(load_good_map(BESS_SOURCE_DIR "/edge/device/meters/" + name + ".toml", variant)) {}
  /// Power in W; -1 with `status` set on failure.
  std::int32_t read() {
    std::int32_t power_w = -1;
    status = meter.read(power_w);
    return power_w;
  }
  void expect_implausible() {
    read();
    EXPECT_EQ(status, Status::kImplausible);
  }

  RegisterMap map;
  RegisterDevice device;
  GridMeter<DeviceLink, DeviceClock> meter{map, DeviceClock(device), -1, device};
  Status status = Status::kOk;
};

TEST(MeterMaps, AllOfThemLoadAsMeters) {
  int maps = 0;
  for (const auto& file :
       std::filesystem::directory_iterator(BESS_SOURCE_DIR "/edge/device/meters")) {
    EXPECT_TRUE(load_good_map(file.path().string()).is_meter) << file.path();
    ++maps;
  }
  EXPECT_EQ(maps, 6);
}

/// "SunS", a common model, then the meter's.
void lay_out_sunspec(RegisterDevice& device, int model) {
  device.set(40'000, {0x5375, 0x6E53, 1, 66});
  device.set(40'070, {model, 105});
  device.set(40'070 + 18, {0xFF85});  // -123
  device.set(40'070 + 22, {1});       // x 10
  device.set(40'177, {0xFFFF, 0});
}

TEST(MeterMaps, SunSpecIsTheTotalPowerAndItsScaleFactor) {
  const std::pair<const char*, int> variants[] = {
      {"three_phase", 203}, {"single_phase", 201}, {"split_phase", 202}, {"delta", 204}};
  for (const auto& [variant, model] : variants) {
    MeterUnderTest t("sunspec", variant);
    lay_out_sunspec(t.device, model);
    EXPECT_EQ(t.read(), -1'230) << variant;
    t.device.set(40'070 + 18, {0x8000});  // "not implemented"
    t.expect_implausible();
  }
  MeterUnderTest other("sunspec", "three_phase");
  lay_out_sunspec(other.device, 213);  // the float models
  other.expect_implausible();
}

TEST(MeterMaps, FroniusIsSunSpecUnderAnotherUnit) {
  MeterUnderTest t("fronius_smart_meter");
  EXPECT_EQ(t.map.unit, 200);
  lay_out_sunspec(t.device, 203);
  EXPECT_EQ(t.read(), -1'230);
}

TEST(MeterMaps, VictronAddsUpItsPhases) {
  MeterUnderTest t("victron_gx");
  EXPECT_EQ(t.map.unit, 100);
  t.device.set(820, {1'500, 0xFFFF - 699, 250});  // -700: one phase may export
  EXPECT_EQ(t.read(), 1'050);
}

TEST(MeterMaps, EastronIsAFloatInInputRegisters) {
  MeterUnderTest t("eastron_sdm630");
  const auto put = [&](int address, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    t.device.set_input(address, {static_cast<int>(bits >> 16), static_cast<int>(bits & 0xFFFF)});
  };
  put(0x0046, 50.02F);
  put(0x0034, -2'345.4F);
  EXPECT_EQ(t.read(), -2'345);
  MeterUnderTest other("eastron_sdm630");  // no frequency there: not this meter
  other.expect_implausible();
}

TEST(MeterMaps, TheP1DonglesTelegramMustMoveOn) {
  MeterUnderTest t("p1_dongle_pro");
  const int time = 1'790'000'000;
  const auto telegram = [&](int at) { t.device.set(0, {at >> 16, at & 0xFFFF}); };
  telegram(time);
  t.device.set(14, {0, 1'234, 0, 0});
  EXPECT_EQ(t.read(), 1'234);
  t.device.set(14, {0, 0, 0, 800});
  t.device.pass_s(30);
  EXPECT_EQ(t.read(), -800);
  t.device.pass_s(1);
  t.expect_implausible();  // the cable to the meter is pulled
  telegram(time + 31);
  EXPECT_EQ(t.read(), -800);
  t.device.set(14, {0xFFFF, 0xFFFF});
  t.expect_implausible();
}

TEST(MeterMaps, ABatterysGridPointIsReadOnDemandAlone) {
  MeterUnderTest none("simulator");
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  t.device.set(0x0021, {0xFFFF, 0xFA24});  // -1500: export
  t.device.unreadable_address = 0x0021;
  EXPECT_FALSE(t.reading().has_grid_power);
  t.device.unreadable_address = -1;
  ASSERT_TRUE(measure_grid_power(t.map));
  EXPECT_TRUE(t.reading().has_grid_power);
  EXPECT_EQ(t.measured.grid_power_w, -1'500);
  MapUnderTest gx(shipped_map("victron_ess3"), "single_phase");
  EXPECT_TRUE(measure_grid_power(gx.map));
  MapUnderTest without(shipped_map("huawei_luna2000"));
  EXPECT_FALSE(measure_grid_power(without.map));
}

TEST(MeterMaps, WhatOnlyABatteryHasIsAMistakeInAMetersMap) {
  const TemporaryFolder folder;
  const std::string head = "[map]\nname = \"m\"\nunit = 1\nkind = \"meter\"\n";
  const std::string point =
      "[[point]]\nname = \"grid_power\"\naddress = 1\nmin = 0\nmax = 9\n[state]\nmeasure = "
      "[\"grid_power\"]\n";
  const std::pair<std::string, const char*> mistakes[] = {
      {head + point + "[power]\ncharge_w_max = 1\ndischarge_w_max = 1\n", "m.toml power"},
      {head + point + "[command]\norder = []\n", "m.toml command"},
      {head + "[[point]]\nname = \"power\"\naddress = 1\nmin = 0\nmax = 9\n[state]\n",
       "\"grid_power\""},
      {"[map]\nname = \"m\"\nunit = 1\nkind = \"clock\"\n" + point, "\"battery\" \"meter\""}};
  for (const auto& [text, message] : mistakes) {
    RegisterMap map;
    std::string error;
    EXPECT_FALSE(load_register_map(folder.write("m.toml", text), "", map, error));
    EXPECT_THAT(error, Names(message));
  }
  load_good_map(folder.write("m.toml", head + point));
}

}  // namespace
}  // namespace bess
