// Maps against manufacturers and other projects: the facts here come from the sources that each
// test names, not from the map, so that a misreading cannot confirm itself.
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
      {"recorded in evcc 17598", false, 0x2B, 0, -1'216, 1'216},
      {"recorded in evcc 18473", false, 0x2B, 0, 0x1F29, 7'977},
      {"recorded in evcc 18838", false, 0, 0, 0xB8, -184},
  };
  for (const SungrowCase& c : cases) {
    MapUnderTest t(shipped_map("sungrow_sh"));
    t.device.set_input(12'999, {0x40, c.state_bits});
    t.device.set_input(13'021, {word(c.power_13021), 505});
    t.device.set_input(5'213, low_first(c.power_5213));
    t.device.set(33'046, {500, 450});
    if (!c.has_5213) t.device.missing = {{.function = 4, .address = 5'213}};
    EXPECT_EQ(t.reading().power_w, c.power_w) << c.firmware;
    EXPECT_EQ(t.measured.lost_point, 0) << c.firmware;
  }
}

/// mkaiser issue 377: 13079 counts down from the written value to 0, then the EMS mode is 0.
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
    EXPECT_FALSE(t.reading().order_replaced || t.measured.order_ended) << i;
    EXPECT_TRUE(t.measured.dispatch_active);
  }
}

/// victronenergy.com, ESS mode 2 and 3, section 1.3: register 37 sets the power at the AC input,
/// which is battery + output; attributes.csv: 23 to 25 are the output's power in 10 W.
TEST(VictronInput, IsWhatTheBatteryTakesAndTheLoadOnTheOutput) {
  constexpr int kVebus = 228;
  int output_w = 800;
  MapUnderTest t(shipped_map("victron_ess3"));
  t.device.before_request = [&] {
    t.device.set(23, {output_w / 10});
    const auto input_w = static_cast<std::int16_t>(t.device.holding[37]);
    t.device.set(842, {word(t.device.holding[2'902] == 3 ? input_w - output_w : 0), 62});
  };
  t.device.set(2'902, {0});  // as it reads on some systems
  for (const int power_w : {0, -1'000, 2'000}) {
    ASSERT_EQ(t.order(power_w), Status::kOk) << power_w;
    EXPECT_EQ(t.reading().power_w, power_w);
    EXPECT_EQ(t.measured.order_power_w, power_w);
    output_w += 1'500;  // a kettle: followed as soon as the set point is sent again
    t.device.pass_s(t.driver->refresh_interval_s());
    ASSERT_EQ(t.driver->refresh(), Status::kOk);
    EXPECT_EQ(t.reading().power_w, power_w);
    EXPECT_FALSE(t.measured.order_replaced);
  }
  EXPECT_EQ(t.device.take_writes().back().unit, kVebus);
}

/// A SMILE-B3 as dxoverdy/Alpha2MQTT recorded it on 2022-09-10, discharging at 3.1 A.
TEST(AlphaEssRecording, ReadsAsItsOwnerSawIt) {
  MapUnderTest t(shipped_map("alphaess"));
  t.device.set(0x0102, {736});
  t.device.set(0x010D, {210});
  t.device.set(0x0110, {250});
  t.device.set(0x0119, {114});
  t.device.set(0x0126, {163});
  t.device.set(0x012C, {5'280, 5'280});
  t.device.set(0x0440, {1});
  EXPECT_EQ(t.reading().soc_e4, 7'360);
  EXPECT_EQ(t.measured.power_w, -163);
  EXPECT_EQ(t.measured.capacity_wh, 11'400);
  EXPECT_EQ(t.measured.temperature_min_deci_c, 210);
  EXPECT_EQ(t.measured.temperature_max_deci_c, 250);
  EXPECT_EQ(t.measured.charge_w_max, 5'280);
}

/// senalse, changelog v1.7.1: function 16 for a single register is answered with exception 2.
TEST(AlphaEssSingles, AreWrittenAndReleasedByTheOtherFunction) {
  for (const char* const variant : {"five_writes", "ten_and_one"}) {
    for (const int refused : {6, 16}) {
      MapUnderTest t(shipped_map("alphaess"), variant);
      fill_alphaess(t.device);
      t.device.refused_single = refused;
      ASSERT_EQ(t.order(-2'000), Status::kOk) << variant << " " << refused;
      EXPECT_EQ(t.device.holding[0x0880], 1);
      EXPECT_EQ(t.device.holding[0x0882], 34'000);
      ASSERT_EQ(t.driver->release(), Status::kOk) << variant << " " << refused;
      EXPECT_EQ(t.device.holding[0x0880], 0);
    }
  }
}

/// Manual: 250 is 100 %; senalse and the Home Assistant community: 255. Neither ends early.
TEST(AlphaEssSoc, ACeilingOfAHundredPercentIsNone) {
  MapUnderTest t(shipped_map("alphaess"), fill_alphaess);
  PowerOrder order{.power_w = 2'000, .soc_min_e4 = 1'000, .soc_max_e4 = 10'000, .duration_s = 300};
  ASSERT_EQ(t.driver->order(order), Status::kOk);
  EXPECT_EQ(t.device.holding[0x0886], 255);
  order.soc_max_e4 = 9'000;
  ASSERT_EQ(t.driver->order(order), Status::kOk);
  EXPECT_EQ(t.device.holding[0x0886], 225);
}

/// evcc solaredge-hybrid: the meter's W counts export as positive (scale -1); the recording in its
/// issue 15445 has -91 W. Kostal's counts import: 307 with exponent 1 on a January evening (18358).
TEST(SunSpecMeter, SignsGridPowerAsTheManufacturerDoes) {
  struct Recording {
    const char* variant;
    std::uint16_t raw;
    std::uint16_t exponent;
    int import_w;
  };
  for (const Recording& c :
       {Recording{"solaredge", 0xFFA5, 0, 91}, Recording{"solaredge", 1'200, 0, -1'200},
        Recording{"", 0x0133, 1, 3'070}}) {
    const RegisterMap map =
        load_good_map(BESS_SOURCE_DIR "/edge/device/meters/sunspec.toml", c.variant);
    PointValues live;
    live.keep(map, find_point(map, "power_sf"), &c.exponent);
    live.keep(map, find_point(map, "grid_power"), &c.raw);
    std::int64_t power_w = 0;
    ASSERT_TRUE(live_power(map, map.grid_power, live, power_w));
    EXPECT_EQ(power_w, c.import_w);
  }
}

}  // namespace
}  // namespace bess
