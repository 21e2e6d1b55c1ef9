// Scenario: battery, prices, faults and events, expectations. Read from a TOML file; times are
// simulated minutes since the start. Its keys, by table:
//   (top)            title, start_utc, minutes (60), time = "both", "virtual" or "wall",
//                    time_scale (60), witness
//   [battery]        map (name or path; alphaess), variant, transport, soc, power_w, capacity_wh,
//                    soc_floor, soc_ceiling (0 to 1), response_delay_ms
//   [prices]         one of file, steps = [[from_min, EUR/MWh], ...], wave; latency_s,
//                    history_hours, missing
//   [house] [meter]  house: one of power_w, steps, seed; meter: map, variant
//   [battery_fault] [meter_fault]
//                    kinds (bess-sim battery --help), from_min, to_min, on_s, off_s; battery only:
//                    every or probability, seed, period_s, late_ms, drip_ms, exception_code
//   [price_fault]    kind, every, from_min, to_min
//   [day_ahead]      file, fault, every, from_min, to_min, mend_min
//   [[event]]        at_min, does; by kind seconds, power_w, for_min, charge_w, discharge_w
//   [[expect]]       from_min, to_min, command, power_w = [least, most], reason, no_reason,
//                    outlook, quarter_hours
//   [edge]           battery, price, guard, meter, limits, other: lines of bess-edge.toml
//   [judge]          all_but, recovery_min, exit_code
//   [same_without]   part = reason
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edge/core/control/outlook.h"
#include "edge/core/control/site_types.h"
#include "shared/battery_model.h"
#include "tools/simulators/battery_sim/battery_faults.h"
#include "tools/simulators/market_sim/auction_view.h"
#include "tools/simulators/market_sim/market_fault.h"

namespace bess {

inline constexpr double kNeverMin = std::numeric_limits<double>::infinity();

/// Span of minutes, without its end.
struct MinuteSpan {
  double from_min = 0;
  double to_min = kNeverMin;
};

/// Default map.
inline constexpr const char* kUsualMap = "alphaess";

struct ScenarioBattery {
  std::string map;      ///< path of the register map
  std::string variant;  ///< empty: the map's first
  bool rtu = false;
  double soc_frac = 0.5;
  /// Wider limits than those of the edge, to detect errors of the edge.
  BatteryParameters physics{
      .power_w_max = 4'000, .capacity_wh = 8'000, .soc_min_frac = 0, .soc_max_frac = 1};
  std::int32_t response_delay_ms = 20;
  bool names_map = false;   ///< the scenario names its map
  bool sets_state = false;  ///< the scenario sets SoC, size or limits
};

/// Value until the next step.
struct ScenarioStep {
  double from_min;
  double value;
};

/// The first step is also valid before it.
inline double step_value_at(const std::vector<ScenarioStep>& steps, double minute) {
  double value = steps.front().value;
  for (const ScenarioStep& step : steps) {
    if (step.from_min <= minute) value = step.value;
  }
  return value;
}

struct ScenarioPrices {
  std::string file;                 ///< minute file; empty: `steps`, or a wave
  std::vector<ScenarioStep> steps;  ///< EUR/MWh
  double wave_mean_eur_per_mwh = 100;
  double wave_amplitude_eur_per_mwh = 400;
  double wave_period_min = 44;
  double latency_s = 2;  ///< from the end of a minute until its row is readable
  /// History that the edge requests at its start; 0: the level is a setting.
  std::int32_t history_hours = 0;
  std::vector<MinuteSpan> missing;  ///< unpublished rows
};

/// House behind the same meter as the battery: none, steps, or drawn from a seed.
struct ScenarioHouse {
  std::vector<ScenarioStep> steps;  ///< W; negative: PV surplus
  std::optional<std::uint64_t> seed{};
  [[nodiscard]] bool exists() const { return !steps.empty() || seed.has_value(); }
};

/// Meter at the connection of the house.
struct ScenarioMeter {
  enum class Source : std::uint8_t { kNone, kMap, kBattery };
  Source source = Source::kNone;  ///< kBattery: the battery's own grid point
  std::string map;                ///< path of its register map
  std::string variant;
  FaultSchedule fault;  ///< of a meter with its own map; no faults: healthy
};

/// Event of a process, its clock or its disk, or a command of people and other programs.
struct ScenarioEvent {
  enum class EventKind : std::uint8_t {
    kEdgeKill,         ///< SIGKILL
    kEdgeStop,         ///< SIGTERM
    kEdgeHandOver,     ///< SIGHUP
    kEdgeStart,        ///< with the same configuration and state
    kEdgePause,        ///< SIGSTOP
    kEdgeContinue,     ///< SIGCONT
    kBatteryPause,     ///< process of the simulator
    kBatteryContinue,  //
    kMarketPause,
    kMarketContinue,
    kMarketKill,
    kMarketStart,
    kClockStep,            ///< the edge's UTC, by `seconds`
    kClockUnsynchronised,  ///< NTP reports no synchronisation
    kClockSynchronised,
    kHold,  ///< bess-edge hold
    kHoldRelease,
    kLimit,       ///< bess-edge limit
    kLimitClear,  //
    kLimitTorn,   ///< half a line, by an interrupted program
    kClear,       ///< bess-edge clear
    kStateLost,   ///< while the edge does not run: its state is unreadable
    kDiskFull,    ///< of the edge's state folder
  };
  double at_min = 0;
  EventKind kind = EventKind::kEdgeStop;
  double seconds = 0;                  ///< of a step of the clock
  std::int32_t power_w = 0;            ///< of a hold
  std::int64_t for_s = 0;              ///< of a hold, or a limit
  std::int32_t charge_w = kAnyPowerW;  ///< of a limit
  std::int32_t discharge_w = kAnyPowerW;
  int line = 0;  ///< in its file
};
/// Command to the edge, not an event of its process.
constexpr bool is_operator_event(ScenarioEvent::EventKind kind) {
  return kind >= ScenarioEvent::EventKind::kHold && kind <= ScenarioEvent::EventKind::kClear;
}
std::string_view event_name(ScenarioEvent::EventKind kind);

/// Command in force that is expected.
struct ExpectedCommand {
  std::string_view name;          ///< in the file
  const char* text;               ///< in a finding
  std::optional<int> direction;   ///< 1 charges, -1 discharges, 0 orders no power; empty: any
  std::optional<bool> is_driven;  ///< by an order, or in its own mode; empty: either
};

inline constexpr ExpectedCommand kExpectedCommands[] = {
    {"any", "anything", {}, {}},
    {"charge", "charging", 1, {}},
    {"discharge", "discharging", -1, {}},
    {"zero", "0 W, held", 0, true},
    {"none", "no order in force", 0, false},
    {"driven", "an order in force", {}, true},
    {"not_driven", "no power ordered", 0, {}},
};

struct Expectation {
  MinuteSpan span;
  /// In every control cycle of the span, from the battery trace.
  ExpectedCommand command = kExpectedCommands[0];
  double power_w_min = -kNeverMin;  ///< of the same commands
  double power_w_max = kNeverMin;
  std::string reason;                            ///< logged at least once in the span; empty: any
  std::string no_reason;                         ///< never logged in the span
  OutlookSource outlook = OutlookSource::kNone;  ///< of every plan in the span
  double quarter_hours_min = -kNeverMin;         ///< known to the plan
  double quarter_hours_max = kNeverMin;
};

struct Scenario {
  std::string name;  ///< of the file
  std::string path;
  std::string title;
  std::int64_t start_utc_s = 0;
  double minutes = 60;
  bool runs_virtual = true;
  bool runs_wall = true;
  std::int32_t time_scale = 60;  ///< of wall time
  ScenarioBattery battery;
  ScenarioPrices prices;
  ScenarioHouse house;
  ScenarioMeter meter;
  // TOML lines of the edge's configuration, by table; `edge_other`: complete tables.
  std::string edge_battery, edge_price, edge_guard, edge_meter, edge_limits, edge_other;
  std::vector<FaultSchedule> battery_faults;  ///< several: only in virtual time
  MarketFaultSchedule price_fault{.every = 1};
  std::optional<AuctionSettings> day_ahead;  ///< with faults
  std::string day_ahead_file;                ///< empty: synthetic
  std::vector<ScenarioEvent> events;         ///< ascending in time
  std::vector<Expectation> expectations;
  std::vector<std::string> invariants;  ///< rules to judge
  bool witness = false;        ///< decode the wire with the manufacturer's table; virtual time
  double recovery_min = 12;    ///< after a fault, until the edge must be in control
  std::int32_t exit_code = 0;  ///< of the edge that runs last
  /// Parts (scenario_parts.h) without effect, each with the reason.
  std::map<std::string, std::string> same_without;

  /// The edge has a limit file.
  [[nodiscard]] bool has_limits() const;
  [[nodiscard]] std::int64_t utc_ns_at(double minute) const;
  /// Some fault of the battery changes the grid power that it shows.
  [[nodiscard]] bool has_grid_fault() const {
    return std::ranges::any_of(battery_faults, [](const FaultSchedule& fault) {
      return std::ranges::any_of(fault.faults, is_of_grid);
    });
  }
  /// Start of the price fault.
  [[nodiscard]] std::int64_t price_fault_utc_s() const {
    return start_utc_s + static_cast<std::int64_t>(price_fault.from_s);
  }
  [[nodiscard]] std::int64_t end_utc_ns() const { return utc_ns_at(minutes); }
};

/// Name in edge/device/maps, for a meter in edge/device/meters; or path relative to `folder`.
std::string map_path(const std::string& name, const std::filesystem::path& folder,
                     bool is_meter = false);
inline constexpr const char* kMapsOfTheBuild =
    " (names are looked up in the tree that bess-hil was built from; after moving it, rebuild)";

/// Throws UserError naming file and line.
Scenario read_scenario(const std::string& path);

}  // namespace bess
