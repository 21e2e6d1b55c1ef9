// Alarms, warnings and device state of the shipped maps, register by register as the sources in
// their heads name them; states that must not block; optional registers.
#include <gmock/gmock.h>

#include "tests/support/register_device.h"

namespace bess {
namespace {

enum class Told { kAlarm, kWarning, kOffGrid, kNothing };

struct StateCase {
  int function, address;
  std::vector<int> registers;
  Told reported;
};

Told told_by(const BatteryMeasurement& m) {
  if (m.off_grid) return Told::kOffGrid;
  if (m.alarm) return Told::kAlarm;
  return m.warning ? Told::kWarning : Told::kNothing;
}

/// Each case alone, in a device that `fill` has made healthy.
void expect_told(const char* map, const std::function<void(RegisterDevice&)>& fill,
                 const std::vector<StateCase>& cases) {
  for (const StateCase& c : cases) {
    MapUnderTest t(shipped_map(map));
    fill(t.device);
    ASSERT_EQ(t.read(), Status::kOk) << map;
    EXPECT_EQ(told_by(t.measured), Told::kNothing) << map;
    if (c.function == 4) {
      t.device.set_input(c.address, c.registers);
    } else {
      t.device.set(c.address, c.registers);
    }
    ASSERT_EQ(t.read(), Status::kOk) << map << " " << c.address;
    EXPECT_EQ(told_by(t.measured), c.reported) << map << " " << c.address << " " << c.registers[0];
  }
}

TEST(DeviceState, AlphaEss) {
  expect_told("alphaess", fill_alphaess,
              {{3, 0x011C, {0, 1}, Told::kWarning},
               {3, 0x011E, {0x8000, 0}, Told::kAlarm},
               {3, 0x0436, {0, 1}, Told::kWarning},
               {3, 0x0438, {1, 0}, Told::kWarning},
               {3, 0x043A, {0, 1}, Told::kAlarm},
               {3, 0x043C, {0, 1}, Told::kAlarm},
               {3, 0x08D4, {0, 1}, Told::kAlarm},
               {3, 0x08D4, {0xFFFF, 0xFFFF}, Told::kNothing},  // not implemented
               {3, 0x0440, {2}, Told::kOffGrid}});
}

TEST(DeviceState, SungrowSh) {
  const auto fill = [](RegisterDevice& device) {
    fill_sungrow(device);
    device.set_input(12'999, {0x40});
    device.set(13'049, {3, 0xAA, 4'000});  // holding: an order, and no alarm
  };
  std::vector<StateCase> cases = {{4, 12'999, {0x0100}, Told::kAlarm},
                                  {4, 12'999, {0x5500}, Told::kAlarm},
                                  {4, 12'999, {0x1000}, Told::kOffGrid},
                                  {4, 12'999, {0x9100}, Told::kWarning},
                                  {4, 12'999, {0x4000}, Told::kNothing}};
  for (const int address :
       {13'053, 13'055, 13'057, 13'059, 13'061, 13'063, 13'065, 13'071, 13'073, 13'075}) {
    cases.push_back({4, address, {1, 0}, Told::kAlarm});
  }
  for (const int address : {13'049, 13'051, 13'067, 13'069, 13'077}) {
    cases.push_back({4, address, {0, 1}, Told::kWarning});
  }
  expect_told("sungrow_sh", fill, cases);
}

TEST(DeviceState, HuaweiLuna2000) {
  const auto fill = [](RegisterDevice& device) {
    fill_huawei(device);
    device.set(32'089, {0x0200});
    device.set(37'762, {2});
  };
  expect_told("huawei_luna2000", fill,
              {{3, 32'003, {0, 1}, Told::kOffGrid},
               {3, 32'003, {0, 2}, Told::kNothing},    // the switch for it
               {3, 32'008, {0x0002}, Told::kAlarm},    // arc
               {3, 32'008, {0x0080}, Told::kWarning},  // grid lost
               {3, 32'008, {0x0010}, Told::kWarning},  // string power
               {3, 32'009, {0x0010}, Told::kAlarm},    // device fault
               {3, 32'009, {0x0200}, Told::kAlarm},    // battery abnormal
               {3, 32'009, {0x0008}, Told::kWarning},  // too warm
               {3, 32'010, {0x0010}, Told::kAlarm},    // battery reversed
               {3, 32'010, {0x0001}, Told::kWarning},  // optimiser
               {3, 32'089, {0x0300}, Told::kAlarm},    // shut down: fault
               {3, 37'762, {3}, Told::kAlarm},
               {3, 37'762, {4}, Told::kNothing}});
}

TEST(DeviceState, FroniusGen24) {
  const auto fill = [](RegisterDevice& device) {
    fill_fronius(device);
    device.set(40'107, {4});
  };
  expect_told("fronius_gen24", fill,
              {{3, 40'107, {7}, Told::kAlarm},
               {3, 40'109, {0, 0x0080}, Told::kAlarm},    // over-temperature
               {3, 40'109, {0, 0x0010}, Told::kWarning},  // grid disconnected
               {3, 40'109, {0xFFFF, 0xFFFF}, Told::kNothing},
               {3, 40'320, {7}, Told::kAlarm},
               {3, 40'340, {7}, Told::kAlarm}});
}

TEST(DeviceState, Sma) {
  const auto fill = [](RegisterDevice& device) {
    device.set(30'201, {0, 307});
    device.set(30'845, {0, 55});
    device.set(31'391, {0, 307});
    device.set(40'236, {0, 2'424});
  };
  expect_told("sma", fill,
              {{3, 30'201, {0, 35}, Told::kAlarm},
               {3, 30'201, {0, 455}, Told::kWarning},
               {3, 30'201, {0, 303}, Told::kNothing},
               {3, 31'391, {0, 35}, Told::kAlarm},
               {3, 31'391, {0, 455}, Told::kWarning},
               {3, 31'391, {0xFFFF, 0xFFFF}, Told::kNothing}});
}

TEST(DeviceState, VictronEss3) {
  std::vector<StateCase> cases = {
      {3, 29, {240}, Told::kOffGrid}, {3, 31, {2}, Told::kAlarm},   {3, 31, {9}, Told::kNothing},
      {3, 32, {26}, Told::kAlarm},    {3, 60, {1}, Told::kAlarm},   {3, 42, {2}, Told::kWarning},
      {3, 43, {2}, Told::kWarning},   {3, 272, {2}, Told::kNothing}};  // low SoC
  for (const int address : {34, 36, 44, 47, 48, 55, 267, 269, 274, 278, 279, 320, 323, 325}) {
    cases.push_back({3, address, {2}, Told::kAlarm});
    cases.push_back({3, address, {1}, Told::kWarning});
  }
  expect_told("victron_ess3", fill_victron, cases);
}

TEST(DeviceState, SunSpec) {
  const auto chain = [](RegisterDevice& device, std::vector<std::pair<int, int>> models) {
    device.set(40'000, {0x5375, 0x6E53, 1, 66});
    int address = 40'070;
    models.emplace_back(0xFFFF, 0);
    for (const auto& [model, length] : models) {
      device.set(address, {model, length});
      address += 2 + length;
    }
  };
  const auto fill_124 = [&](RegisterDevice& device) {
    chain(device, {{103, 50}, {124, 24}});
    device.set(40'070 + 38, {4});
    device.set(40'122 + 2, {5'000});
    device.set(40'122 + 8, {62});
  };
  expect_told("sunspec_124", fill_124,
              {{3, 40'070 + 38, {7}, Told::kAlarm},
               {3, 40'070 + 40, {0, 1}, Told::kAlarm},
               {3, 40'070 + 40, {0, 0x0400}, Told::kWarning},
               {3, 40'070 + 40, {0xFFFF, 0xFFFF}, Told::kNothing}});
  const int bank = 40'070 + 155 + 67;
  const auto fill_704 = [&](RegisterDevice& device) {
    chain(device, {{701, 153}, {704, 65}, {802, 62}});
    device.set(40'070 + 4, {3});
    device.set(bank + 3, {8'000, 4'000, 3'500});
    device.set(bank + 11, {50});
    device.set(bank + 22, {3});
  };
  expect_told("sunspec_704", fill_704,
              {{3, 40'070 + 4, {6}, Told::kAlarm},
               {3, 40'070 + 4, {7}, Told::kNothing},   // standby
               {3, 40'070 + 6, {1, 0}, Told::kAlarm},  // manufacturer-specific
               {3, 40'070 + 6, {0, 0x0010}, Told::kWarning},
               {3, bank + 22, {99}, Told::kAlarm},
               {3, bank + 26, {0, 1}, Told::kAlarm},  // communication lost
               {3, bank + 26, {0, 2}, Told::kAlarm},  // over-temperature
               {3, bank + 26, {0, 4}, Told::kWarning},
               {3, bank + 26, {0x0020, 0}, Told::kWarning},         // fan
               {3, bank + 26, {0x0001, 0xE000}, Told::kNothing}});  // SoC near its limits
}

/// A battery that supplies the house must be released by a restarted controller.
TEST(DeviceState, AStartInBypassCanReleaseALeftoverOrder) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  t.device.set(0x0440, {2});
  t.device.set(0x0880, {1, 0, 28'000, 0, 32'000, 2, 225, 0, 300, 255, 0});
  EXPECT_TRUE(t.reading().off_grid);
  EXPECT_TRUE(t.measured.dispatch_active);
  EXPECT_THAT(t.release_writes(), ::testing::ElementsAre(fc16(
                                      0x0880, {0, 0, 32'000, 0, 32'000, 0, 0, 0, 90, 255, 0}, 85)));
  t.device.set(0x0440, {3});
  MapUnderTest other(shipped_map("alphaess"));
  EXPECT_EQ(other.read(), Status::kImplausible) << "no such work mode is known";
}

/// It shows no SoC then: nothing is driven, but an order of an earlier run is ended.
TEST(DeviceState, AnSmaBatteryThatSleepsIsStillThisDevice) {
  MapUnderTest t(shipped_map("sma"), "bms_mode");
  t.device.set(30'845, {0xFFFF, 0xFFFF});
  t.device.set(40'236, {0, 2'289});
  EXPECT_EQ(t.read(), Status::kImplausible);
  ASSERT_EQ(t.driver->release(), Status::kOk);
  EXPECT_EQ(t.device.holding[40'237], 2'424);
  MapUnderTest foreign(shipped_map("sma"), "bms_mode");
  foreign.device.set(30'845, {0, 106});
  EXPECT_EQ(foreign.driver->release(), Status::kImplausible);
  EXPECT_THAT(foreign.device.writes, ::testing::IsEmpty());
}

TEST(DeviceState, TheLowestBatteryPowerIsNoPower) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.set(0x0126, {0x8000});
  EXPECT_EQ(t.read(), Status::kImplausible);
}

TEST(OptionalPoint, ARegisterThatEveryDeviceHasIsNotDoneWithout) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  ASSERT_EQ(t.read(), Status::kOk);
  t.device.missing = {{.address = 0x0126}};
  EXPECT_EQ(t.read(), Status::kBusException);
}

/// Behind a GX the battery's service may be absent, as other exceptions show.
TEST(OptionalPoint, AnAbsentUnitBehindAGatewayIsDoneWithout) {
  for (const int exception : {2, 10, 11}) {
    MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
    for (int address = 259; address < 330; ++address) {
      t.device.missing.push_back({.address = address, .exception = exception});
    }
    ASSERT_EQ(t.read(), Status::kOk) << exception;
    t.device.set(31, {2});
    EXPECT_TRUE(t.reading().alarm) << exception;
  }
}

/// A register that the device lacks splits the reads around it, and no others.
TEST(OptionalPoint, SplitsOnlyReadsOfItsUnitTableAndPlace) {
  RegisterMap map;
  map.read_gap_registers_max = 10;
  const auto at = [](std::int32_t unit, std::uint8_t function, std::uint16_t address) {
    return PlacedPoint{
        .place = {.unit = unit, .address = address, .count = 1, .function = function}};
  };
  const auto reads = [&](const PlacedPoint& missing) {
    PlacedPoints points, refused;
    points.push_back(at(1, 3, 100));
    points.push_back(at(1, 3, 104));
    refused.push_back(missing);
    ReadPlan plan;
    plan_reads(map, points, refused, plan);
    return plan.size();
  };
  EXPECT_EQ(reads(at(1, 3, 102)), 2);
  for (const PlacedPoint& elsewhere : {at(2, 3, 102), at(1, 4, 102), at(1, 3, 99), at(1, 3, 105)}) {
    EXPECT_EQ(reads(elsewhere), 1) << elsewhere.place.address;
  }
}

/// Any other answer may be temporary: the register is still read.
TEST(OptionalPoint, IsNotAbandonedForAnotherException) {
  MapUnderTest t(shipped_map("victron_ess3"), fill_victron);
  t.device.missing = {{.address = 267, .exception = 4}};
  EXPECT_EQ(t.read(), Status::kBusException);
  t.device.missing.clear();
  t.device.set(267, {2});
  EXPECT_TRUE(t.reading().alarm);
}

TEST(OptionalPoint, AModelThatIsThereAgainIsReadAgain) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  t.device.set(0x08D4, {0, 1});
  t.device.missing = {{.address = 0x08D4}};
  EXPECT_FALSE(t.reading().alarm);
  t.device.missing.clear();  // the device was starting
  t.device.pass_s(601);
  EXPECT_TRUE(t.reading().alarm);
}

TEST(ResponseBand, OnlyHybridsChargeByThemselves) {
  for (const MapVariant& variant : kShippedMapVariants) {
    const std::string_view name = variant.map;
    const bool is_hybrid =
        name == "fronius_gen24" || name == "solaredge" || name == "kostal_plenticore";
    EXPECT_EQ(load_shipped_map(variant).response.charges_by_itself, is_hybrid) << variant.map;
  }
}

}  // namespace
}  // namespace bess
