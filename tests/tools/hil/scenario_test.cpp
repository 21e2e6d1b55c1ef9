// Scenario files: what is read, what is refused with one clear line, and that the shipped ones
// leave no fault, no map and no event of the list out.
#include "tools/hil_runner/scenario/scenario.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "shared/host/user_error.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tools/battery_sim/battery_faults.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

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
  try {
    static_cast<void>(read_scenario(folder.write("s.toml", text)));
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Scenarios, AtLeastThirtyAreShippedEachWithATitle) {
  const std::vector<Scenario> all = shipped();
  EXPECT_GE(all.size(), 30U);
  for (const Scenario& s : all) EXPECT_FALSE(s.title.empty()) << s.name;
}

TEST(Scenarios, EveryFaultOfTheBatteryIsInOneOnEachBusThatHasIt) {
  std::set<std::pair<BatteryFault, bool>> tried;
  for (const Scenario& s : shipped()) {
    for (const BatteryFaultWindow& window : s.battery_faults) {
      for (const BatteryFault fault : window.schedule.faults) {
        tried.insert({fault, s.battery.rtu});
      }
    }
    for (const BatteryFault fault : s.meter.fault.schedule.faults) {
      if (is_of_grid(fault)) tried.insert({fault, false});
    }
  }
  for (const BatteryFaultInfo& info : battery_faults()) {
    // What the battery does, not what the bus makes of it, is the same on both.
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
  std::set<ScenarioEvent::Does> tried;
  for (const Scenario& s : shipped()) {
    for (const ScenarioEvent& event : s.events) tried.insert(event.does);
  }
  for (int i = 0; i <= static_cast<int>(ScenarioEvent::Does::kDiskFull); ++i) {
    const auto does = static_cast<ScenarioEvent::Does>(i);
    EXPECT_TRUE(tried.contains(does)) << event_name(does);
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
    tried.insert(s.meter.fault.schedule.faults.begin(), s.meter.fault.schedule.faults.end());
  }
  using enum BatteryFault;
  for (const BatteryFault fault : {kSilence, kFrozen, kWrongSign, kGridScaled, kGridRatio,
                                   kGridOffset, kGridLate, kGridOtherPhase}) {
    EXPECT_TRUE(tried.contains(fault)) << static_cast<int>(fault);
  }
}

TEST(Scenarios, WhatIsWrongOfTheSiteIsSaidWithItsLine) {
  const std::string site = "title = \"x\"\n[house]\npower_w = 500\n[meter]\nmap = \"simulator\"\n";
  EXPECT_EQ(refusal(site), "");
  EXPECT_THAT(refusal("title = \"x\"\n[house]\npower_w = 500\n"),
              HasSubstr("s.toml:2: house needs [meter]: else nobody would see it"));
  EXPECT_THAT(refusal("title = \"x\"\n[meter]\nmap = \"simulator\"\n"),
              HasSubstr("s.toml:2: meter needs [house]"));
  EXPECT_THAT(refusal("title = \"x\"\n[house]\npower_w = 500\nseed = 3\n"),
              HasSubstr("s.toml:3: [house] power_w or steps or seed: exactly one"));
  EXPECT_THAT(refusal("title = \"x\"\n[house]\n"), HasSubstr("s.toml:2: [house] power_w or steps"));
  EXPECT_THAT(refusal("title = \"x\"\n[house]\nsteps = [[3, 1], [2, 1]]\n"),
              HasSubstr("in the order of time"));
  EXPECT_THAT(refusal("title = \"x\"\n[house]\nsteps = [[0, 1], [60, 2]]\n[meter]\nmap = "
                      "\"simulator\"\n"),
              HasSubstr("s.toml:3: [house] steps is after the end of 60 minutes"));
  EXPECT_THAT(refusal("title = \"x\"\n[meter]\nmap = \"nobody\"\n"),
              HasSubstr("s.toml:3: [meter] map names no register map"));
  EXPECT_THAT(refusal("title = \"x\"\n[meter_fault]\nkinds = [\"frozen\"]\n"),
              HasSubstr("s.toml:3: [meter_fault] kinds need [meter]"));
  EXPECT_THAT(refusal(site + "[meter_fault]\nkinds = [\"half-flow\"]\n"),
              HasSubstr("s.toml:7: is of a battery, not of a meter"));
  EXPECT_THAT(refusal(site + "[meter_fault]\nkinds = [\"frozen\"]\non_s = 30\n"),
              HasSubstr("comes with the other of on_s and off_s"));
  EXPECT_THAT(refusal(site + "[battery_fault]\nkinds = [\"grid-scaled\"]\n"),
              HasSubstr("battery_fault kinds: grid-... need [meter] map = \"battery\""));
  EXPECT_THAT(refusal("title = \"x\"\n[edge]\nmeter = \"import_w_max = 1\"\n"),
              HasSubstr("edge meter: needs [meter], which is read"));
  EXPECT_THAT(refusal("title = \"x\"\n[edge]\nother = \"[limits]\"\n"),
              HasSubstr("edge other: lines of [limits] go into the key limits"));
}

TEST(Scenarios, WhatIsWrongOfWhatPeopleSayIsSaidWithItsLine) {
  const std::string event = "title = \"x\"\n[[event]]\nat_min = 1\n";
  EXPECT_THAT(refusal(event + "does = \"hold\"\nfor_min = 9\n"),
              HasSubstr("s.toml:2: [[event]] power_w is missing"));
  EXPECT_THAT(refusal(event + "does = \"hold\"\npower_w = 10\n"), HasSubstr("for_min is missing"));
  EXPECT_THAT(refusal(event + "does = \"hold\"\npower_w = 10\nfor_min = 1\n"),
              HasSubstr("s.toml:6: [[event]] for_min must be a number from 2 to"));
  EXPECT_THAT(refusal(event + "does = \"hold\"\npower_w = 4001\nfor_min = 9\n"),
              HasSubstr("hold: 4001 W is more than the battery's 4000"));
  EXPECT_THAT(refusal(event + "does = \"hold_release\"\npower_w = 1\n"), HasSubstr("power_w"));
  EXPECT_THAT(refusal(event + "does = \"limit\"\nfor_min = 9\n"), HasSubstr("charge_w is missing"));
  EXPECT_THAT(refusal(event + "does = \"limit\"\ncharge_w = -1\nfor_min = 9\n"),
              HasSubstr("s.toml:5: [[event]] charge_w"));
  EXPECT_THAT(refusal(event + "does = \"clear\"\nseconds = 3\n"), HasSubstr("seconds"));
  EXPECT_THAT(refusal("title = \"x\"\n[[expect]]\npower_w = [3, 1]\n"),
              HasSubstr("s.toml:3: [[expect]] power_w must be [least, most]"));
  EXPECT_THAT(refusal("title = \"x\"\n[prices]\nhistory_hours = 97\n"),
              HasSubstr("s.toml:3: [prices] history_hours"));
}

TEST(Scenarios, WhatIsWrongIsSaidWithItsLine) {
  EXPECT_THAT(refusal("minutes = 60\n"), HasSubstr("title"));
  EXPECT_THAT(refusal("title = \"x\"\nminuts = 3\n"), HasSubstr("s.toml:2: "));
  EXPECT_THAT(refusal("title = \"x\"\nminutes = 600\n"), HasSubstr("time = \"virtual\" alone"));
  EXPECT_THAT(refusal("title = \"x\"\nstart_utc = \"2023-03-26T00:01:00Z\"\n"),
              HasSubstr("at an even minute"));
  EXPECT_THAT(refusal("title = \"x\"\n[battery]\nmap = \"nobody\"\n"),
              HasSubstr("no register map"));
  EXPECT_THAT(refusal("title = \"x\"\n[battery_fault]\nkinds = [\"silense\"]\n"),
              HasSubstr("s.toml:3: no fault of the battery (see bess-sim battery --help)"));
  EXPECT_THAT(refusal("title = \"x\"\n[battery]\ntransport = \"rtu\"\n[battery_fault]\nkinds = "
                      "[\"drop\"]\n"),
              HasSubstr("only without a serial line"));
  EXPECT_THAT(
      refusal("title = \"x\"\n[battery_fault]\nkinds = [\"drop\"]\nfrom_min = 5\nto_min = 5\n"),
      HasSubstr("must be later than from_min"));
  EXPECT_THAT(refusal("title = \"x\"\n[[event]]\nat_min = 1\ndoes = \"edge_die\"\n"),
              HasSubstr("must be one of: edge_kill"));
  EXPECT_THAT(refusal("title = \"x\"\n[[event]]\nat_min = 1\ndoes = \"clock_step\"\nseconds = 3\n"),
              HasSubstr("must be \"virtual\""));
  EXPECT_THAT(refusal("title = \"x\"\n[[event]]\nat_min = 60\ndoes = \"edge_kill\"\n"),
              HasSubstr("s.toml:3: [[event]] at_min is after the end of 60 minutes"));
  EXPECT_THAT(refusal("title = \"x\"\n[battery]\nsoc_floor = 0.8\nsoc_ceiling = 0.2\n"),
              HasSubstr("below soc_ceiling"));
  EXPECT_THAT(refusal("title = \"x\"\n[[expect]]\nreason = \"mood\"\n"),
              HasSubstr("no reason of the guard"));
  EXPECT_THAT(refusal("title = \"x\"\n[judge]\nall_but = [\"everything\"]\n"),
              HasSubstr("no invariant"));
  EXPECT_THAT(refusal("title = \"x\"\n[prices]\nsteps = [[3, 1], [2, 1]]\n"),
              HasSubstr("in the order of time"));
  EXPECT_THAT(refusal("title = \"x\"\n[price_fault]\nkind = \"frozen\"\nto_min = 9\n"),
              HasSubstr("s.toml:3: [price_fault] kind frozen lasts to the end"));
}

TEST(Scenarios, SeveralFaultsAreReadInTheirOrder) {
  const TemporaryFolder folder;
  const std::string two =
      "[[battery_fault]]\nkinds = [\"late\"]\nlate_ms = 300\nto_min = 5\n"
      "[[battery_fault]]\nkinds = [\"master-stops\", \"alarm\"]\nfrom_min = 9\nperiod_s = 40\n";
  const std::string head = "title = \"x\"\ntime = \"virtual\"\n";
  const Scenario scenario = read_scenario(folder.write("s.toml", head + two));
  ASSERT_EQ(scenario.battery_faults.size(), 2U);
  EXPECT_EQ(scenario.battery_faults[0].late_ms, 300);
  EXPECT_EQ(scenario.battery_faults[1].schedule.from_s, 540);
  EXPECT_EQ(scenario.battery_faults[1].schedule.faults.size(), 2U);
  EXPECT_THAT(refusal("title = \"x\"\n" + two),
              HasSubstr("s.toml:2: battery_fault several of them need time = \"virtual\""));
  EXPECT_THAT(refusal(head + two + "[[battery_fault]]\nkinds = [\"ends-orders\"]\n"),
              HasSubstr("period_s must be the same in all that have one"));
  EXPECT_THAT(refusal(head + two + "[[battery_fault]]\nkinds = [\"alarm\"]\nto_min = 61\n"),
              HasSubstr("s.toml:13: [[battery_fault]] to_min is after the end of 60 minutes"));
}

TEST(Scenarios, AStateIsNotLostUnderAnEdgeThatRuns) {
  EXPECT_THAT(refusal("title = \"x\"\n[[event]]\nat_min = 1\ndoes = \"state_lost\"\n"),
              HasSubstr("s.toml:2: [[event]] state_lost at minute 1 is in vain: the edge runs"));
}

TEST(Scenarios, AnExpectationThatNoRunCouldBreakIsRefused) {
  const std::string expect = "title = \"x\"\n[[expect]]\n";
  EXPECT_EQ(refusal(expect + "command = \"driven\"\n"), "");
  EXPECT_EQ(refusal(expect + "from_min = 57.5\ncommand = \"driven\"\n"), "");  // the tick of 58
  EXPECT_THAT(
      refusal(expect + "from_min = 4\nto_min = 9\n"),
      HasSubstr("s.toml:2: [[expect]] command or power_w, reason, no_reason or outlook: else"));
  EXPECT_THAT(refusal(expect + "command = \"any\"\n"),
              HasSubstr("s.toml:3: [[expect]] command or power_w"));
  EXPECT_THAT(refusal(expect + "from_min = 10.5\nto_min = 12\ncommand = \"zero\"\n"),
              HasSubstr("s.toml:4: [[expect]] to_min leaves no tick: they are 2 minutes apart"));
  EXPECT_THAT(refusal(expect + "from_min = 58.5\ncommand = \"zero\"\n"),
              HasSubstr("s.toml:3: [[expect]] from_min leaves no tick"));
  EXPECT_THAT(refusal(expect + "power_w = [-4000, 4000]\n"),
              HasSubstr("s.toml:3: [[expect]] power_w leaves nothing out: the battery has 4000 W"));
  EXPECT_THAT(refusal(expect + "from_min = 60\ncommand = \"zero\"\n"),
              HasSubstr("s.toml:3: [[expect]] from_min is after the end of 60 minutes"));
  EXPECT_THAT(refusal(expect + "to_min = 61\ncommand = \"zero\"\n"),
              HasSubstr("s.toml:3: [[expect]] to_min is after the end of 60 minutes"));
}

TEST(Scenarios, AnExpectationThatNoRunCouldKeepIsRefused) {
  const std::string expect = "title = \"x\"\n[[expect]]\n";
  const auto ruled_out = HasSubstr("s.toml:4: [[expect]] power_w rules out its command");
  EXPECT_THAT(refusal(expect + "command = \"charge\"\npower_w = [-9, 0]\n"), ruled_out);
  EXPECT_THAT(refusal(expect + "command = \"discharge\"\npower_w = [0, 9]\n"), ruled_out);
  for (const char* const command : {"zero", "none", "not_driven"}) {
    const std::string line = std::string("command = \"").append(command).append("\"\n");
    EXPECT_THAT(refusal(expect + line + "power_w = [1, 9]\n"), ruled_out) << command;
    EXPECT_EQ(refusal(expect + line + "power_w = [0, 9]\n"), "") << command;
  }
  EXPECT_THAT(refusal(expect + "reason = \"ramp\"\nno_reason = \"ramp\"\n"),
              HasSubstr("s.toml:4: [[expect]] no_reason rules out its reason"));
}

TEST(Scenarios, KeysThatContradictEachOtherOrAreOfNothingHereAreRefused) {
  const auto of = [](const std::string& lines) { return refusal("title = \"x\"\n" + lines); };
  EXPECT_THAT(of("[prices]\nsteps = [[0, 1]]\nwave = { mean = 9 }\n"),
              HasSubstr("s.toml:3: [prices] steps file, steps or wave: at most one"));
  EXPECT_THAT(of("[prices]\nmissing = [[20, 10]]\n"),
              HasSubstr("s.toml:3: [prices] missing holds no minute"));
  EXPECT_THAT(of("[prices]\nmissing = [[20.2, 20.8]]\n"), HasSubstr("missing holds no minute"));
  EXPECT_THAT(of("[prices]\nsteps = [[3, 1], [3, 2]]\n"), HasSubstr("in the order of time"));
  EXPECT_THAT(of("time = \"virtual\"\ntime_scale = 9\n"),
              HasSubstr("s.toml:3: time_scale is of wall time"));
  const std::string fault = "[battery_fault]\nkinds = [\"silence\"]\n";
  EXPECT_THAT(of(fault + "every = 2\nprobability = 0.5\n"),
              HasSubstr("s.toml:4: [battery_fault] every or probability: at most one"));
  for (const char* const key : {"late_ms", "drip_ms", "exception_code", "period_s"}) {
    EXPECT_THAT(of(fault + key + " = 9\n"),
                HasSubstr(std::string("s.toml:4: [battery_fault] ").append(key).append(" is of ")));
  }
}

TEST(Scenarios, WhatBeginsOrEndsAfterTheEndIsRefusedWithItsLine) {
  const auto of = [](const std::string& lines) { return refusal("title = \"x\"\n" + lines); };
  EXPECT_THAT(of("[battery_fault]\nkinds = [\"silence\"]\nfrom_min = 60\n"),
              HasSubstr("s.toml:4: [battery_fault] from_min is after the end of 60 minutes"));
  EXPECT_THAT(of("[price_fault]\nkind = \"null\"\nto_min = 61\n"),
              HasSubstr("s.toml:4: [price_fault] to_min is after the end"));
  EXPECT_THAT(of("[house]\npower_w = 1\n[meter]\nmap = \"simulator\"\n[meter_fault]\nkinds = "
                 "[\"frozen\"]\nfrom_min = 70\n"),
              HasSubstr("s.toml:8: [meter_fault] from_min is after the end"));
  EXPECT_THAT(of("[prices]\nsteps = [[0, 1],\n[60, 2]]\n"),
              HasSubstr("s.toml:4: [prices] steps is after the end"));
  EXPECT_THAT(of("[prices]\nmissing = [[60, 62]]\n"),
              HasSubstr("s.toml:3: [prices] missing is after the end"));
}

TEST(Scenarios, AnEventThatFindsNothingToDoIsRefusedWithItsLine) {
  const auto of = [](std::initializer_list<const char*> events) {
    std::string text = "title = \"x\"\ntime = \"virtual\"\n";
    int at_min = 0;
    for (const char* const does : events) {
      text += fmt::format("[[event]]\nat_min = {}\ndoes = \"{}\"\n", ++at_min, does);
    }
    return refusal(text);
  };
  EXPECT_THAT(of({"edge_start"}),
              HasSubstr("s.toml:3: [[event]] edge_start at minute 1 is in vain: the edge runs"));
  EXPECT_THAT(of({"edge_kill", "edge_stop"}), HasSubstr("s.toml:6: [[event]] edge_stop"));
  for (const char* const end : {"edge_continue", "battery_continue", "market_continue",
                                "market_start", "clock_back", "hold_release", "limit_clear"}) {
    EXPECT_THAT(of({end}), HasSubstr("is in vain")) << end;
  }
  for (const char* const begin : {"edge_pause", "battery_pause", "market_pause", "market_kill",
                                  "clock_lost", "edge_hand_over"}) {
    EXPECT_EQ(of({begin}), "") << begin;
    EXPECT_THAT(of({begin, begin}), HasSubstr("s.toml:6: [[event]]")) << begin;
  }
  EXPECT_THAT(refusal("title = \"x\"\ntime = \"virtual\"\n[[event]]\nat_min = 1\ndoes = "
                      "\"clock_step\"\n"),
              HasSubstr("seconds is missing"));
  EXPECT_THAT(refusal("title = \"x\"\ntime = \"virtual\"\n[[event]]\nat_min = 1\ndoes = "
                      "\"clock_step\"\nseconds = 0\n"),
              HasSubstr("s.toml:6: [[event]] seconds must not be 0"));
}

TEST(Scenarios, AnExcuseIsOfAPartAndSaysWhy) {
  EXPECT_THAT(refusal("title = \"x\"\n[same_without]\n\"event 1\" = \"why\"\n"),
              HasSubstr("s.toml:3: [same_without] event 1 is no part of this scenario, which has "
                        "nothing"));
  EXPECT_THAT(refusal("title = \"x\"\n[same_without]\nnothing = \"\"\n"),
              HasSubstr("s.toml:3: [same_without] nothing says not why"));
}

}  // namespace
}  // namespace bess
