#include "tools/hil_runner/scenario/scenario_event.h"

#include <algorithm>
#include <cmath>

#include "edge/control/hold.h"
#include "tools/hil_runner/scenario/scenario_reader.h"

namespace bess {
namespace {

constexpr std::string_view kEventNames[] = {
    "edge_kill",    "edge_stop",       "edge_hand_over", "edge_start",
    "edge_pause",   "edge_continue",   "battery_pause",  "battery_continue",
    "market_pause", "market_continue", "market_kill",    "market_start",
    "clock_step",   "clock_lost",      "clock_back",     "hold",
    "hold_release", "limit",           "limit_clear",    "limit_torn",
    "clear",        "state_lost",      "disk_full"};

/// How long it holds, in whole seconds, as the command lines take it.
void read_for_min(TomlTable& table, double minutes_min, std::int64_t& for_s) {
  constexpr double kWeekMin = 7 * 24 * 60;
  double minutes = 0;
  table.require("for_min");
  read_decimal(table, "for_min", minutes, minutes_min, kWeekMin);
  for_s = std::llround(60 * minutes);
}

/// What belongs to one kind of event alone.
void read_what_is_said(TomlTable& table, ScenarioEvent& event) {
  using enum ScenarioEvent::Does;
  constexpr std::int64_t kPowerWMax = 100'000'000;
  if (event.does == kClockStep) {
    table.require("seconds");
    read_decimal(table, "seconds", event.seconds, -86'400, 86'400);
    if (table.ok() && event.seconds == 0) table.fail("seconds", "must not be 0");
  } else if (event.does == kHold) {
    table.require("power_w");
    table.integer("power_w", event.power_w, -kPowerWMax, kPowerWMax);
    read_for_min(table, kHoldSecondsMin / 60.0, event.for_s);
  } else if (event.does == kLimit || event.does == kLimitTorn) {
    if (!table.has("charge_w") && !table.has("discharge_w")) table.require("charge_w");
    table.integer("charge_w", event.charge_w, 0, kPowerWMax);
    table.integer("discharge_w", event.discharge_w, 0, kPowerWMax);
    read_for_min(table, 0.1, event.for_s);
  }
}

/// Events that find nothing to do: what is to end has not begun, or what is to begin has.
void check_order_of_events(TomlTable& table, const Scenario& scenario) {
  using enum ScenarioEvent::Does;
  enum Thing : std::uint8_t {
    kEdgeRuns,
    kEdgeStands,
    kBatteryStands,
    kMarketStands,
    kMarketIsDead,
    kClockIsLost,
    kIsHeld,
    kIsLimited,
    kThingCount
  };
  struct Turn {
    ScenarioEvent::Does does;
    Thing thing;
    bool turns_to;
    const char* in_vain;  ///< why, where it is so already; null: it may be
  };
  constexpr Turn kTurns[] = {
      {kEdgeKill, kEdgeRuns, false, "the edge does not run"},
      {kEdgeStop, kEdgeRuns, false, "the edge does not run"},
      {kEdgeHandOver, kEdgeRuns, false, "the edge does not run"},
      {kEdgeStart, kEdgeRuns, true, "the edge runs"},
      {kStateLost, kEdgeRuns, true, "the edge runs, and keeps it open"},
      {kEdgePause, kEdgeStands, true, "the edge stands still"},
      {kEdgeContinue, kEdgeStands, false, "the edge does not stand still"},
      {kBatteryPause, kBatteryStands, true, "the battery stands still"},
      {kBatteryContinue, kBatteryStands, false, "the battery does not stand still"},
      {kMarketPause, kMarketStands, true, "the market stands still"},
      {kMarketContinue, kMarketStands, false, "the market does not stand still"},
      {kMarketKill, kMarketIsDead, true, "the market does not run"},
      {kMarketStart, kMarketIsDead, false, "the market runs"},
      {kClockUnsynchronised, kClockIsLost, true, "the clock is lost"},
      {kClockSynchronised, kClockIsLost, false, "the clock is not lost"},
      {kHold, kIsHeld, true, nullptr},
      {kHoldRelease, kIsHeld, false, "nobody holds the battery"},
      {kLimit, kIsLimited, true, nullptr},
      {kLimitTorn, kIsLimited, true, nullptr},
      {kLimitClear, kIsLimited, false, "nobody limits the battery"}};
  bool is[kThingCount] = {};
  is[kEdgeRuns] = true;
  for (const ScenarioEvent& event : scenario.events) {
    const auto* const turn = std::ranges::find(kTurns, event.does, &Turn::does);
    if (turn == std::end(kTurns)) continue;
    if (is[turn->thing] == turn->turns_to && turn->in_vain != nullptr && table.ok()) {
      table.error() = fmt::format("{}:{}: [[event]] {} at minute {:g} is in vain: {}", table.file(),
                                  event.line, event_name(event.does), event.at_min, turn->in_vain);
    }
    if (event.does != kStateLost) is[turn->thing] = turn->turns_to;
  }
}

/// What only one of the two times can do, and what the edge would refuse.
void check_times(TomlTable& table, const Scenario& scenario) {
  using enum ScenarioEvent::Does;
  for (const ScenarioEvent& event : scenario.events) {
    if (std::abs(event.power_w) > scenario.battery.physics.power_w_max) {
      table.fail("event", fmt::format("hold: {} W is more than the battery's {:g}", event.power_w,
                                      scenario.battery.physics.power_w_max));
    }
    const bool of_clock = event.does == kClockStep || event.does == kClockUnsynchronised ||
                          event.does == kClockSynchronised;
    if (of_clock && scenario.runs_wall) {
      table.fail("time", "must be \"virtual\": the clock of this machine is not stepped");
    }
    if (event.does == kDiskFull && scenario.runs_virtual) {
      table.fail("time", "must be \"wall\": in virtual time there is no disk");
    }
  }
}

}  // namespace

std::string_view event_name(ScenarioEvent::Does does) {
  return kEventNames[static_cast<std::size_t>(does)];
}

void read_event(TomlTable table, Scenario& scenario) {
  ScenarioEvent event;
  table.require("at_min");
  read_decimal(table, "at_min", event.at_min, 0, kScenarioMinutesMax);
  if (table.ok() && event.at_min >= scenario.minutes) {
    table.fail("at_min", after_the_end(scenario.minutes));
  }
  if (table.value() != nullptr) event.line = table.value()->line;
  table.require("does");
  const std::string* const does = table.text("does");
  const auto* const found = std::ranges::find(kEventNames, does == nullptr ? "" : *does);
  if (table.ok() && found == std::end(kEventNames)) {
    std::string names;
    for (const std::string_view name : kEventNames) names += ' ' + std::string(name);
    return table.fail("does", "must be one of:" + names);
  }
  event.does = static_cast<ScenarioEvent::Does>(found - std::begin(kEventNames));
  read_what_is_said(table, event);
  table.finish();
  scenario.events.push_back(event);
}

void check_events(TomlTable& root, const Scenario& scenario) {
  check_times(root, scenario);
  check_order_of_events(root, scenario);
}

}  // namespace bess
