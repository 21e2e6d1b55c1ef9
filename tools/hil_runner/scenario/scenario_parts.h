// Parts of a scenario: house, meter, events, expectations, read from its file and checked. Removing
// a part must change the run; otherwise it tests nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/simulators/battery_sim/house_load.h"

namespace bess {

// House load of a scenario, for the simulators of both times and for the judge.

/// File for bess-sim battery --house, with one more hour on both sides. Only for a house with
/// steps.
std::string house_csv(const Scenario& scenario);

HouseLoad house_load(const Scenario& scenario);

// Tables [house], [meter] and [meter_fault] of a scenario.

void read_house(TomlTable table, Scenario& scenario);
void read_meter(TomlTable table, const std::filesystem::path& folder, ScenarioMeter& meter);
void read_meter_fault(TomlTable table, Scenario& scenario);

/// Refuses a house without a meter and the reverse, and settings without their device.
void check_site(TomlTable& root, const Scenario& scenario);

/// Table [day_ahead]: published day-ahead prices and their faults, for a student with context
/// outlook. A relative `file` is in `folder`, that of the scenario.
void read_day_ahead(TomlTable table, const std::filesystem::path& folder, Scenario& scenario);

// Tables [[event]] of a scenario.

void read_event(TomlTable table, Scenario& scenario);

/// Refuses events, ascending in time, that the edge refuses, that the time cannot run, or without
/// effect.
void check_events(TomlTable& root, const Scenario& scenario);

// Tables [[expect]] of a scenario.

/// Also refuses expectations that no run can violate or none can meet.
void read_expectation(TomlTable table, Scenario& scenario);

struct ScenarioPart {
  std::string name;  ///< as in [same_without]: battery_fault, event 2, edge guard soc_min
  Scenario without;  ///< scenario without this part
};

/// In the order of the format; empty: no faults and only defaults.
std::vector<ScenarioPart> parts_of(const Scenario& scenario);

/// Name in [same_without] for a scenario without parts.
inline constexpr std::string_view kNothing = "nothing";

}  // namespace bess
