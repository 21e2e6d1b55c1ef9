// Real battery of bess-hil: its options, none with a guessed default, and its data.
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

// Real battery: address, limits, and suitable scenarios. Its commands are decoded from the recorded
// bus traffic; its behaviour is known only from its measurements.

struct RealBattery {
  std::string address{};  ///< as given; empty: no real battery
  std::string map{};      ///< path; of the options: as given
  std::string variant{};  ///< empty: the map's first
  std::optional<int> unit{};
  std::optional<int> baud{};
  double capacity_wh = 0;
  double power_w = 0;        ///< maximum of an order
  double soc_min_frac = -1;  ///< negative: not given
  double soc_max_frac = -1;
  std::int32_t time_scale = 1;  ///< of a bess-sim battery used instead
  bool is_sure = false;         ///< confirmed on the command line

  [[nodiscard]] bool is_serial() const { return address.starts_with('/'); }
};

/// Reason why a scenario cannot run on a real battery; empty: it can.
std::string why_not_real(const Scenario& scenario);
/// The same for this battery.
std::string why_not_real(const Scenario& scenario, const RealBattery& battery);

/// The scenario with this battery, its limits and its time scale.
Scenario on_real_battery(Scenario scenario, const RealBattery& battery);

/// Keys of the edge's [battery] table for its link.
std::string link_keys(const RealBattery& battery);

/// Orders and their ends until `end_utc_ns`, decoded with the map from recordings in the order of
/// time. Throws UserError for a damaged recording.
std::vector<DispatchEvent> orders_on_the_bus(const std::vector<std::string>& recordings,
                                             const RegisterMap& map, std::int64_t end_utc_ns);
/// Measurements in the decision log: each reading represents the control cycle that it ends.
/// Commanded power is unknown.
std::vector<MinuteRecord> measured_minutes(const std::vector<CycleRecord>& log);

/// Violation of the limits; empty: none. Independent of the edge's guard.
std::string beyond_limits(const CycleRecord& cycle, const RealBattery& battery);

/// `options` must outlive the command.
void add_real_options(ProgramCommand& command, RealBattery& options);

/// Empty without --real. Throws UserError for contradicting options.
std::optional<RealBattery> real_battery(const RealBattery& options);

}  // namespace bess
