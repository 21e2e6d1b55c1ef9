// Scenario files: accepted keys, refusals with one clear line, and that the shipped ones cover
// every listed fault, map and event.
#include "tools/hil_runner/scenario/scenario.h"

#include <fmt/core.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tools/simulators/battery_sim/battery_faults.h"

namespace bess {
namespace {

std::vector<Scenario> shipped() {
  std::vector<Scenario> all;
  for (const auto& entry :
       std::filesystem::directory_iterator(BESS_SOURCE_DIR "/tests/scenarios")) {
    if (entry.path().extension() == ".toml") all.push_back(read_scenario(entry.path().string()));
  }
  return all;
}

std::string refusal(const std::string& text) {
  const TemporaryFolder folder;
  return refusal_of([&] { return read_scenario(folder.write("s.toml", text)); });
}

TEST(Scenarios, EveryFaultOfTheBatteryIsInOneOnEachBusThatHasIt) {
  std::set<std::pair<BatteryFault, bool>> tried;
  for (const Scenario& s : shipped()) {
    for (const FaultSchedule& window : s.battery_faults) {
      for (const BatteryFault fault : window.faults) {
        tried.insert({fault, s.battery.rtu});
      }
    }
    for (const BatteryFault fault : s.meter.fault.faults) {
      if (is_of_grid(fault)) tried.insert({fault, false});
    }
  }
  for (const BatteryFaultInfo& info : battery_faults()) {
    // The battery's behaviour, apart from effects of the bus, is the same on both.
    const bool is_of_bus = info.fault <= BatteryFault::kBadCrc;
    const bool over_tcp = tried.contains({info.fault, false}) || !info.tcp;
    const bool over_rtu = tried.contains({info.fault, true}) || !info.rtu || !is_of_bus;
    EXPECT_TRUE(over_tcp && over_rtu) << info.name;
  }
}

TEST(Scenarios, EveryFaultOfThePricesIsInOne) {
  std::set<MarketFault> tried;
  for (const Scenario& s : shipped()) tried.insert(s.price_fault.fault);
  EXPECT_EQ(tried.size(), std::size(kMarketFaultNames));
}

TEST(Scenarios, EveryEventIsInOne) {
  std::set<ScenarioEvent::EventKind> tried;
  for (const Scenario& s : shipped()) {
    for (const ScenarioEvent& event : s.events) tried.insert(event.kind);
  }
  for (int i = 0; i <= static_cast<int>(ScenarioEvent::EventKind::kDiskFull); ++i) {
    const auto kind = static_cast<ScenarioEvent::EventKind>(i);
    EXPECT_TRUE(tried.contains(kind)) << event_name(kind);
  }
}

TEST(Scenarios, EveryShippedMapIsInOne) {
  std::set<std::string> tried;
  for (const Scenario& s : shipped()) {
    tried.insert(std::filesystem::path(s.battery.map).stem().string() + " " + s.battery.variant);
  }
  for (const MapVariant& wanted : kShippedMapVariants) {
    const std::string name = wanted.map;
    const bool is_default = name == "alphaess" && std::string(wanted.variant) == "block";
    EXPECT_TRUE(tried.contains(name + " " + (is_default ? "" : wanted.variant)))
        << name << " " << wanted.variant;
  }
}

TEST(Scenarios, WhatAMeterCanDoWrongIsInOne) {
  std::set<BatteryFault> tried;
  for (const Scenario& s : shipped()) {
    tried.insert(s.meter.fault.faults.begin(), s.meter.fault.faults.end());
  }
  using enum BatteryFault;
  for (const BatteryFault fault : {kSilence, kFrozen, kWrongSign, kGridScaled, kGridRatio,
                                   kGridOffset, kGridLate, kGridOtherPhase}) {
    EXPECT_TRUE(tried.contains(fault)) << static_cast<int>(fault);
  }
}

/// Lines below a title, and the codes of their refusal.
struct Refused {
  std::string lines;
  std::string codes;
};

void expect_refused(const std::vector<Refused>& rows) {
  for (const Refused& row : rows) {
    EXPECT_THAT(refusal("title = \"x\"\n" + row.lines), Names(row.codes)) << row.lines;
  }
}

TEST(Scenarios, AMistakeIsReportedWithItsLine) {
  EXPECT_THAT(refusal("minutes = 60\n"), Names("title"));
  expect_refused({
      {"minuts = 3\n", "s.toml:2"},
      {"minutes = 600\n", "s.toml:2 time \"virtual\""},
      {"start_utc = \"2023-03-26T00:01:00Z\"\n", "s.toml:2 start_utc"},
      {"[battery]\nmap = \"nobody\"\n", "s.toml:3 map"},
      {"[battery_fault]\nkinds = [\"silense\"]\n", "s.toml:3 bess-sim battery --help"},
      {"[battery]\ntransport = \"rtu\"\n[battery_fault]\nkinds = [\"drop\"]\n", "s.toml:5"},
      {"[battery_fault]\nkinds = [\"drop\"]\nfrom_min = 5\nto_min = 5\n", "s.toml:5 from_min"},
      {"[[event]]\nat_min = 1\ndoes = \"edge_die\"\n", "s.toml:4 does edge_kill"},
      {"[[event]]\nat_min = 1\ndoes = \"clock_step\"\nseconds = 3\n", "s.toml \"virtual\""},
      {"[[event]]\nat_min = 60\ndoes = \"edge_kill\"\n", "s.toml:3 [[event]] at_min 60"},
      {"[battery]\nsoc_floor = 0.8\nsoc_ceiling = 0.2\n", "s.toml:3 soc_floor soc_ceiling"},
      {"[[expect]]\nreason = \"mood\"\n", "s.toml:3 reason"},
      {"[judge]\nall_but = [\"everything\"]\n", "s.toml:3 bess-hil --invariants"},
      {"[prices]\nsteps = [[3, 1], [2, 1]]\n", "s.toml:3 steps"},
      {"[prices]\nhistory_hours = 97\n", "s.toml:3 [prices] history_hours"},
      {"[price_fault]\nkind = \"frozen\"\nto_min = 9\n", "s.toml:3 [price_fault] kind frozen"},
  });
}

TEST(Scenarios, AMistakeOfTheSiteIsReportedWithItsLine) {
  const std::string site = "[house]\npower_w = 500\n[meter]\nmap = \"simulator\"\n";
  EXPECT_EQ(refusal("title = \"x\"\n" + site), "");
  expect_refused({
      {"[house]\npower_w = 500\n", "s.toml:2 house [meter]"},
      {"[meter]\nmap = \"simulator\"\n", "s.toml:2 meter [house]"},
      {"[house]\npower_w = 500\nseed = 3\n", "s.toml:3 [house] power_w steps seed"},
      {"[house]\n", "s.toml:2 [house] power_w steps"},
      {"[house]\nsteps = [[3, 1], [2, 1]]\n", "s.toml:3 steps"},
      {"[house]\nsteps = [[0, 1], [60, 2]]\n[meter]\nmap = \"simulator\"\n",
       "s.toml:3 [house] steps 60"},
      {"[meter]\nmap = \"nobody\"\n", "s.toml:3 [meter] map"},
      {"[meter_fault]\nkinds = [\"frozen\"]\n", "s.toml:3 [meter_fault] kinds [meter]"},
      {site + "[meter_fault]\nkinds = [\"half-flow\"]\n", "s.toml:7"},
      {site + "[meter_fault]\nkinds = [\"frozen\"]\non_s = 30\n", "on_s off_s"},
      {site + "[battery_fault]\nkinds = [\"grid-scaled\"]\n",
       "battery_fault kinds grid-... [meter] map \"battery\""},
      {"[edge]\nmeter = \"import_w_max = 1\"\n", "edge meter [meter]"},
      {"[edge]\nother = \"[limits]\"\n", "edge other [limits] limits"},
  });
}

TEST(Scenarios, AMistakeInOperatorEventsIsReportedWithItsLine) {
  const std::string event = "[[event]]\nat_min = 1\n";
  expect_refused({
      {event + "does = \"hold\"\nfor_min = 9\n", "s.toml:2 [[event]] power_w"},
      {event + "does = \"hold\"\npower_w = 10\n", "s.toml:2 for_min"},
      {event + "does = \"hold\"\npower_w = 10\nfor_min = 1\n", "s.toml:6 [[event]] for_min 2"},
      {event + "does = \"hold\"\npower_w = 4001\nfor_min = 9\n", "hold 4001 4000"},
      {event + "does = \"hold_release\"\npower_w = 1\n", "power_w"},
      {event + "does = \"limit\"\nfor_min = 9\n", "charge_w"},
      {event + "does = \"limit\"\ncharge_w = -1\nfor_min = 9\n", "s.toml:5 [[event]] charge_w"},
      {event + "does = \"clear\"\nseconds = 3\n", "seconds"},
      {event + "does = \"state_lost\"\n", "s.toml:2 [[event]] state_lost 1"},
  });
}

TEST(Scenarios, SeveralFaultsAreReadInTheirOrder) {
  const TemporaryFolder folder;
  const std::string two =
      "[[battery_fault]]\nkinds = [\"late\"]\nlate_ms = 300\nto_min = 5\n"
      "[[battery_fault]]\nkinds = [\"master-stops\", \"alarm\"]\nfrom_min = 9\nperiod_s = 40\n";
  const std::string head = "time = \"virtual\"\n";
  const Scenario scenario = read_scenario(folder.write("s.toml", "title = \"x\"\n" + head + two));
  ASSERT_EQ(scenario.battery_faults.size(), 2U);
  EXPECT_EQ(scenario.battery_faults[0].late_ms, 300);
  EXPECT_EQ(scenario.battery_faults[1].from_s, 540);
  EXPECT_EQ(scenario.battery_faults[1].faults.size(), 2U);
  expect_refused({
      {two, "s.toml:2 battery_fault time \"virtual\""},
      {head + two + "[[battery_fault]]\nkinds = [\"ends-orders\"]\n", "period_s"},
      {head + two + "[[battery_fault]]\nkinds = [\"alarm\"]\nto_min = 61\n",
       "s.toml:13 [[battery_fault]] to_min 60"},
  });
}

TEST(Scenarios, AnExpectationThatNoRunCouldBreakOrKeepIsRefused) {
  const std::string expect = "[[expect]]\n";
  const auto accepted = [&](const std::string& lines) {
    return refusal("title = \"x\"\n" + expect + lines);
  };
  EXPECT_EQ(accepted("command = \"driven\"\n"), "");
  EXPECT_EQ(accepted("from_min = 57.5\ncommand = \"driven\"\n"), "");  // the tick of 58
  expect_refused({
      {expect + "from_min = 4\nto_min = 9\n",
       "s.toml:2 [[expect]] command power_w reason no_reason outlook"},
      {expect + "command = \"any\"\n", "s.toml:3 [[expect]] command power_w"},
      {expect + "from_min = 10.5\nto_min = 12\ncommand = \"zero\"\n", "s.toml:4 [[expect]] to_min"},
      {expect + "from_min = 58.5\ncommand = \"zero\"\n", "s.toml:3 [[expect]] from_min"},
      {expect + "power_w = [3, 1]\n", "s.toml:3 [[expect]] power_w"},
      {expect + "power_w = [-4000, 4000]\n", "s.toml:3 [[expect]] power_w 4000"},
      {expect + "from_min = 60\ncommand = \"zero\"\n", "s.toml:3 [[expect]] from_min 60"},
      {expect + "to_min = 61\ncommand = \"zero\"\n", "s.toml:3 [[expect]] to_min 60"},
      {expect + "command = \"charge\"\npower_w = [-9, 0]\n", "s.toml:4 [[expect]] power_w"},
      {expect + "command = \"discharge\"\npower_w = [0, 9]\n", "s.toml:4 [[expect]] power_w"},
      {expect + "reason = \"ramp\"\nno_reason = \"ramp\"\n", "s.toml:4 [[expect]] no_reason"},
  });
  for (const char* const command : {"zero", "none", "not_driven"}) {
    const std::string line = std::string("command = \"").append(command).append("\"\n");
    expect_refused({{expect + line + "power_w = [1, 9]\n", "s.toml:4 [[expect]] power_w"}});
    EXPECT_EQ(accepted(line + "power_w = [0, 9]\n"), "") << command;
  }
}

TEST(Scenarios, KeysThatContradictEachOtherOrAreOfNothingHereAreRefused) {
  const std::string fault = "[battery_fault]\nkinds = [\"silence\"]\n";
  expect_refused({
      {"[prices]\nsteps = [[0, 1]]\nwave = { mean = 9 }\n", "s.toml:3 [prices] file steps wave"},
      {"[prices]\nmissing = [[20, 10]]\n", "s.toml:3 [prices] missing"},
      {"[prices]\nmissing = [[20.2, 20.8]]\n", "s.toml:3 [prices] missing"},
      {"[prices]\nsteps = [[3, 1], [3, 2]]\n", "s.toml:3 [prices] steps"},
      {"time = \"virtual\"\ntime_scale = 9\n", "s.toml:3 time_scale"},
      {fault + "every = 2\nprobability = 0.5\n", "s.toml:4 [battery_fault] every probability"},
      {"[same_without]\n\"event 1\" = \"why\"\n", "s.toml:3 [same_without] event 1 nothing"},
      {"[same_without]\nnothing = \"\"\n", "s.toml:3 [same_without] nothing"},
      // Starts or ends after the end.
      {fault + "from_min = 60\n", "s.toml:4 [battery_fault] from_min 60"},
      {"[price_fault]\nkind = \"null\"\nto_min = 61\n", "s.toml:4 [price_fault] to_min"},
      {"[house]\npower_w = 1\n[meter]\nmap = \"simulator\"\n[meter_fault]\nkinds = [\"frozen\"]\n"
       "from_min = 70\n",
       "s.toml:8 [meter_fault] from_min"},
      {"[prices]\nsteps = [[0, 1],\n[60, 2]]\n", "s.toml:4 [prices] steps"},
      {"[prices]\nmissing = [[60, 62]]\n", "s.toml:3 [prices] missing"},
  });
  for (const std::string key : {"late_ms", "drip_ms", "exception_code", "period_s"}) {
    expect_refused({{fault + key + " = 9\n", "s.toml:4 [battery_fault] " + key}});
  }
}

TEST(Scenarios, AnEventThatFindsNothingToDoIsRefusedWithItsLine) {
  const auto of = [](std::initializer_list<const char*> events) {
    std::string text = "title = \"x\"\ntime = \"virtual\"\n";
    int at_min = 0;
    for (const char* const kind : events) {
      text += fmt::format("[[event]]\nat_min = {}\ndoes = \"{}\"\n", ++at_min, kind);
    }
    return refusal(text);
  };
  EXPECT_THAT(of({"edge_start"}), Names("s.toml:3 [[event]] edge_start 1"));
  EXPECT_THAT(of({"edge_kill", "edge_stop"}), Names("s.toml:6 [[event]] edge_stop"));
  for (const char* const end : {"edge_continue", "battery_continue", "market_continue",
                                "market_start", "clock_back", "hold_release", "limit_clear"}) {
    EXPECT_THAT(of({end}), Names(std::string("s.toml:3 [[event]] 1 ") + end));
  }
  for (const char* const begin : {"edge_pause", "battery_pause", "market_pause", "market_kill",
                                  "clock_lost", "edge_hand_over"}) {
    EXPECT_EQ(of({begin}), "") << begin;
    EXPECT_THAT(of({begin, begin}), Names("s.toml:6 [[event]]")) << begin;
  }
  const std::string step = "time = \"virtual\"\n[[event]]\nat_min = 1\ndoes = \"clock_step\"\n";
  expect_refused(
      {{step, "s.toml:3 seconds"}, {step + "seconds = 0\n", "s.toml:6 [[event]] seconds 0"}});
}

}  // namespace
}  // namespace bess
