// A real battery behind bess-hil: its options on the command line, none of them guessed, and what
// is known of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "shared/host/command_line.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

// A battery that is there already, and may be hurt: where it is, the limits that it is driven
// within, and which scenarios may drive it. Of a real one only its bus is known: what it was told
// is read off the recorded bytes, what it did is what it measured.

struct RealBattery {
  std::string address;    ///< as it was given
  std::string map;        ///< path
  std::string variant{};  ///< empty: the map's first
  std::optional<int> unit{};
  std::optional<int> baud{};
  double capacity_wh = 0;
  double power_w = 0;  ///< no order is larger
  double soc_min_frac = 0;
  double soc_max_frac = 0;
  std::int32_t time_scale = 1;  ///< another where bess-sim stands for it at that scale

  [[nodiscard]] bool is_serial() const { return address.starts_with('/'); }
};

/// Why a scenario must not or cannot drive a real battery, in words; empty: it may.
std::string why_not_real(const Scenario& scenario);
/// The same of this battery in particular.
std::string why_not_real(const Scenario& scenario, const RealBattery& battery);

/// The scenario with this battery, its limits and its pace.
Scenario on_real_battery(Scenario scenario, const RealBattery& battery);

/// Lines of the edge's [battery] table that lead to it.
std::string link_keys(const RealBattery& battery);

/// What a device that acts by its map was told, by recordings of its bus in the order of time, and
/// what became of that until `end_utc_ns`. Throws UserError when one is damaged.
std::vector<DispatchEvent> orders_on_the_bus(const std::vector<std::string>& recordings,
                                             const RegisterMap& map, std::int64_t end_utc_ns);
/// What it measured, in the edge's log: each reading stands for the cycle that it ends. Commanded
/// power is not known.
std::vector<MinuteRecord> measured_minutes(const std::vector<CycleRecord>& log);

/// What breaks the limits, in words; empty: nothing does. It stands beside the edge's own guard.
std::string beyond_limits(const CycleRecord& cycle, const RealBattery& battery);

struct RealOptions {
  std::string address, map, variant;
  bool is_sure = false;
  std::optional<int> unit, baud;
  std::optional<double> capacity_wh, power_w, soc_min_frac, soc_max_frac;
  int time_scale = 1;
};

/// `options` must outlive the command.
void add_real_options(ProgramCommand& command, RealOptions& options);

/// Nothing without --real. Throws UserError when the options contradict each other.
std::optional<RealBattery> real_battery(const RealOptions& options);

}  // namespace bess
