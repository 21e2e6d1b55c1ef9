// A scenario: which battery, which prices, what goes wrong and when, what is expected of the edge.
// Read from a commented TOML file (tests/scenarios/README.md is the format); times are simulated
// minutes since the start.
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

/// From a minute up to, not including, another.
struct MinuteSpan {
  double from_min = 0;
  double to_min = kNeverMin;
};

/// Of a scenario that names none.
inline constexpr const char* kUsualMap = "alphaess";

struct ScenarioBattery {
  std::string map;      ///< path of the register map
  std::string variant;  ///< empty: the map's first
  bool rtu = false;
  double soc_frac = 0.5;
  /// Its own limits are wider than the edge's, so that what the edge lets happen shows.
  BatteryParameters physics{
      .power_w_max = 4'000, .capacity_wh = 8'000, .soc_min_frac = 0, .soc_max_frac = 1};
  std::int32_t response_delay_ms = 20;
  bool names_map = false;   ///< the scenario is about this map
  bool sets_state = false;  ///< SoC, size or limits are the scenario's, not just any
};

struct ScenarioPrices {
  struct Step {
    double from_min;
    double eur_per_mwh;
  };
  std::string file;         ///< a minute file; empty: `steps`, or a wave
  std::vector<Step> steps;  ///< each price until the next
  double wave_mean_eur_per_mwh = 100;
  double wave_amplitude_eur_per_mwh = 400;
  double wave_period_min = 44;
  double latency_s = 2;  ///< from the end of a minute until its row is readable
  /// That the edge asks the market for at its start; 0: the level that they lead to is its setting.
  std::int32_t history_hours = 0;
  std::vector<MinuteSpan> missing;  ///< rows that are never published
};

struct BatteryFaultWindow {
  FaultSchedule schedule;  ///< its span in seconds; no faults: nothing goes wrong
  std::int32_t late_ms = 1'500;
  std::int32_t drip_ms = 100;
  std::int32_t exception_code = 6;
  [[nodiscard]] bool strikes_always() const {
    return !schedule.faults.empty() && schedule.every == 1 && schedule.probability == 0 &&
           schedule.off_s == 0;
  }
};

/// The house behind the same meter as the battery: none, steps, or a household drawn from a seed.
struct ScenarioHouse {
  struct Step {
    double from_min;
    double power_w;  ///< negative: more sun than load
  };
  std::vector<Step> steps;  ///< each load until the next, the first before it too
  std::optional<std::uint64_t> seed{};
  [[nodiscard]] bool exists() const { return !steps.empty() || seed.has_value(); }
};

/// The meter at the house's connection.
struct ScenarioMeter {
  enum class Source : std::uint8_t { kNone, kMap, kBattery };
  Source source = Source::kNone;  ///< kBattery: the battery's own grid point
  std::string map;                ///< path of its register map
  std::string variant;
  BatteryFaultWindow fault;  ///< of one with a map of its own
};

struct PriceFaultWindow {
  MarketFault fault = MarketFault::kNone;
  std::int32_t every = 1;
  MinuteSpan span;
};

/// What happens to a process, its clock or its disk, and what people and other programs say to the
/// edge.
struct ScenarioEvent {
  enum class Does : std::uint8_t {
    kEdgeKill,         ///< SIGKILL
    kEdgeStop,         ///< SIGTERM
    kEdgeHandOver,     ///< SIGHUP
    kEdgeStart,        ///< with the same configuration and state
    kEdgePause,        ///< SIGSTOP
    kEdgeContinue,     ///< SIGCONT
    kBatteryPause,     ///< of the simulators' processes
    kBatteryContinue,  //
    kMarketPause,
    kMarketContinue,
    kMarketKill,
    kMarketStart,
    kClockStep,            ///< the edge's UTC, by `seconds`
    kClockUnsynchronised,  ///< NTP says that it is not to be trusted
    kClockSynchronised,
    kHold,  ///< bess-edge hold
    kHoldRelease,
    kLimit,       ///< bess-edge limit
    kLimitClear,  //
    kLimitTorn,   ///< by a program that writes only half of its line
    kClear,       ///< bess-edge clear
    kStateLost,   ///< while the edge does not run: what it left cannot be understood
    kDiskFull,    ///< of the edge's state folder
  };
  double at_min = 0;
  Does does = Does::kEdgeStop;
  double seconds = 0;                  ///< of a step of the clock
  std::int32_t power_w = 0;            ///< of a hold
  std::int64_t for_s = 0;              ///< of a hold, or a limit
  std::int32_t charge_w = kAnyPowerW;  ///< of a limit
  std::int32_t discharge_w = kAnyPowerW;
  int line = 0;  ///< of its file
};
/// Somebody says something to the edge, rather than doing something to it.
constexpr bool is_of_people(ScenarioEvent::Does does) {
  return does >= ScenarioEvent::Does::kHold && does <= ScenarioEvent::Does::kClear;
}
std::string_view event_name(ScenarioEvent::Does does);

struct Expectation {
  enum class Command : std::uint8_t {
    kAny,
    kCharge,
    kDischarge,
    kZero,       ///< the battery is held at 0 W
    kNone,       ///< it is in its own mode
    kDriven,     ///< it follows an order, whichever
    kNotDriven,  ///< 0 W or its own mode
  };
  MinuteSpan span;
  Command command =
      Command::kAny;  ///< of every cycle that begins in the span, by the battery's record
  double power_w_min = -kNeverMin;  ///< of the same cycles' commands
  double power_w_max = kNeverMin;
  std::string reason;     ///< that the edge logs at least once in the span; empty = any
  std::string no_reason;  ///< that it never logs in the span
  OutlookSource outlook = OutlookSource::kNone;  ///< of every plan that it logs in the span
  double quarter_hours_min = -kNeverMin;         ///< that were known to it
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
  // Lines of TOML for the edge's configuration, by its tables; `edge_other` is whole tables.
  std::string edge_battery, edge_price, edge_guard, edge_meter, edge_limits, edge_other;
  std::vector<BatteryFaultWindow> battery_faults;  ///< several: in virtual time
  PriceFaultWindow price_fault;
  std::optional<AuctionSettings> day_ahead;  ///< and what goes wrong with those prices
  std::string day_ahead_file;                ///< empty: they are made up
  std::vector<ScenarioEvent> events;         ///< in the order of time
  std::vector<Expectation> expectations;
  std::vector<std::string> invariants;  ///< that are judged
  bool witness = false;                 ///< the wire is read by the maker's table too; virtual time
  double recovery_min = 12;             ///< after a fault, until the edge must drive again
  std::int32_t exit_code = 0;           ///< of the edge that runs last
  /// Parts (scenario_parts.h) that change nothing when they are taken away, each with the reason.
  std::map<std::string, std::string> same_without;

  /// The edge has a limit file.
  [[nodiscard]] bool has_limits() const;
  [[nodiscard]] std::int64_t utc_ns_at(double minute) const;
  /// Some fault of the battery is of this kind: `is_kind(BatteryFault)`.
  template <typename IsKind>
  [[nodiscard]] bool has_battery_fault(const IsKind& is_kind) const {
    return std::ranges::any_of(battery_faults, [&](const BatteryFaultWindow& fault) {
      return std::ranges::any_of(fault.schedule.faults, is_kind);
    });
  }
  /// From which on the price server is wrong.
  [[nodiscard]] std::int64_t price_fault_utc_s() const {
    return start_utc_s + static_cast<std::int64_t>(60 * price_fault.span.from_min);
  }
  [[nodiscard]] std::int64_t end_utc_ns() const { return utc_ns_at(minutes); }
};

/// A map is named as in edge/device/maps, or by its path, relative to `folder`.
std::string map_path(const std::string& name, const std::filesystem::path& folder);

/// Throws UserError naming file and line.
Scenario read_scenario(const std::string& path);

}  // namespace bess
