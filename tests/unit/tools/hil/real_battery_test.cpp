// Real battery: the scenarios that may drive it, its orders by the bytes on its bus, and violations
// of its limits.
#include "tools/hil_runner/real/real_options.h"

#include <gmock/gmock.h>

#include <map>

#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"

namespace bess {
namespace {

using enum DispatchEvent::Kind;

Scenario shipped(const std::string& name) {
  return read_scenario(BESS_SOURCE_DIR "/tests/scenarios/" + name + ".toml");
}

RealBattery battery() {
  return {.address = "192.168.1.20:502",
          .map = shipped_map("alphaess"),
          .capacity_wh = 8'000,
          .power_w = 500,
          .soc_min_frac = 0.3,
          .soc_max_frac = 0.7};
}

TEST(RealBattery, IsNotDrivenByScenariosForSimulatedOnes) {
  const std::map<std::string, std::string> reasons = {{"bus_silence", "silence"},
                                                      {"edge_killed", "edge_kill"},
                                                      {"edge_handed_over", "edge_hand_over"},
                                                      {"battery_paused", "battery_pause"},
                                                      {"clock_steps_back", "virtual"},
                                                      {"map_fronius_gen24", "fronius_gen24"}};
  for (const auto& [name, reason] : reasons) {
    EXPECT_THAT(why_not_real(shipped(name), battery()), Names(reason)) << name;
  }
  for (const char* name : {"prices_beyond_thresholds", "rtu_quiet_hour"}) {
    EXPECT_NE(why_not_real(shipped(name), battery()), "") << name;
  }
  for (const char* name : {"quiet_hour", "prices_outage_half_hour", "edge_stopped"}) {
    EXPECT_EQ(why_not_real(shipped(name), battery()), "") << name;
  }
}

TEST(RealBattery, UsesItsLimitsInsteadOfTheScenarios) {
  const Scenario scenario = on_real_battery(shipped("quiet_hour"), battery());
  EXPECT_EQ(scenario.time_scale, 1);
  EXPECT_EQ(scenario.battery.physics.power_w_max, 500);
  EXPECT_EQ(scenario.edge_guard, "soc_min = 0.3000\nsoc_max = 0.7000");
  EXPECT_EQ(link_keys(battery()), "host = \"192.168.1.20\"\nport = 502\n");
  RealBattery serial = battery();
  serial.address = "/dev/ttyUSB0";
  serial.baud = 19'200;
  serial.unit = 7;
  EXPECT_EQ(link_keys(serial),
            "transport = \"rtu\"\ndevice = \"/dev/ttyUSB0\"\nbaud = 19200\nunit = 7\n");
}

TEST(RealBattery, LimitsAreBrokenByOrderByFlowAndBySoc) {
  const CycleRecord good{.has_measurement = true,
                         .measurement = {.soc_e4 = 5'000, .power_w = -520},
                         .ordered_power_w = -500};
  EXPECT_EQ(beyond_limits(good, battery()), "");
  CycleRecord cycle = good;
  cycle.ordered_power_w = 501;
  EXPECT_THAT(beyond_limits(cycle, battery()), Names("501 W"));
  cycle = good;
  cycle.measurement.power_w = 801;
  EXPECT_THAT(beyond_limits(cycle, battery()), Names("801 W"));
  cycle = good;
  cycle.measurement.soc_e4 = 7'150;
  EXPECT_THAT(beyond_limits(cycle, battery()), Names("71.5 %"));
  cycle.has_measurement = false;
  EXPECT_EQ(beyond_limits(cycle, battery()), "");
}

TEST(RealBattery, AReadingBelongsToTheCycleThatItEnds) {
  const CycleRecord cycle{
      .utc_s = 1'200, .has_measurement = true, .measurement = {.soc_e4 = 5'000, .power_w = 600}};
  const std::vector<MinuteRecord> minutes = measured_minutes({cycle, {.utc_s = 1'320}});
  ASSERT_EQ(minutes.size(), 2U);
  EXPECT_EQ(minutes[0].minute_utc_s, 1'080);
  EXPECT_EQ(minutes[1].minute_utc_s, 1'140);
  EXPECT_EQ(minutes[1].energy_wh, 10);
  EXPECT_EQ(minutes[1].soc_frac, 0.5);
}

constexpr const char* kHead =
    R"({"bess_recording":1,"version":"0.1.0","map":"alphaess","variant":"block","unit":85,"units":{},)"
    R"("transport":"tcp","begin":"2023-03-26T00:00:00Z","time_scale":1})"
    "\n";

/// alphaess, block: start, power (32000 is 0, less is charging), mode, SoC limit, seconds.
std::string write_line(const char* clock, int start, int power, int seconds, const char* outcome) {
  return fmt::format(
      R"({{"utc":"2023-03-26T{}Z","unit":85,"function":16,"address":2176,"count":11,"latency_us":1000,{})"
      R"("values":[{},0,{},0,32000,2,175,0,{},255,0]}})"
      "\n",
      clock, outcome, start, power, seconds);
}

TEST(RealBattery, ItsOrdersAreReadFromItsBus) {
  const TemporaryFolder folder;
  const std::string first = folder.write(
      "first.jsonl", kHead + write_line("00:00:05.000000", 1, 31'500, 300, "") +
                         write_line("00:02:05.000000", 1, 32'500, 300, R"("error":"timeout",)") +
                         write_line("00:02:06.000000", 1, 32'400, 60, ""));
  const std::string second =
      folder.write("second.jsonl", kHead + write_line("00:04:05.000000", 1, 31'500, 300, "") +
                                       write_line("00:05:00.000000", 0, 32'000, 90, ""));
  const std::vector<DispatchEvent> events = orders_on_the_bus(
      {first, second}, load_shipped_map({"alphaess", "block"}), 1'679'790'000 * 1'000'000'000LL);
  ASSERT_EQ(events.size(), 5U);
  const std::pair<DispatchEvent::Kind, double> wanted[] = {
      {kOrder, 500}, {kOrder, -400}, {kExpiry, 0}, {kOrder, 500}, {kStop, 0}};
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].kind, wanted[i].first) << i;
    EXPECT_EQ(events[i].power_w, wanted[i].second) << i;
  }
}

TEST(RealBattery, ADamagedRecordingOfItsBusIsNamed) {
  const TemporaryFolder folder;
  const std::string path = folder.write("bus.jsonl", std::string(kHead) + "{]\n");
  const RegisterMap map = load_shipped_map({"alphaess", "block"});
  EXPECT_THAT(user_error_of([&] { return orders_on_the_bus({path}, map, 0); }),
              Names("bus.jsonl:2"));
}

}  // namespace
}  // namespace bess
