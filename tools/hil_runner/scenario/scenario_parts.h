// The parts of a scenario: house, meter, events, expectations, as read from its file and checked.
// Removing one of them must change the run; otherwise it tests nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/toml_reader.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/simulators/battery_sim/house_load.h"

namespace bess {

// The load of a scenario's house, for the simulators of both times and for the judge.

/// A file for bess-sim battery --house, an hour wider than the scenario on both sides. Of a house
/// with steps alone.
std::string house_csv(const Scenario& scenario);

HouseLoad house_load(const Scenario& scenario);

// The tables of a scenario that are about the site: the house behind the same meter, the meter, and
// what is wrong with it.

void read_house(TomlTable table, Scenario& scenario);
void read_meter(TomlTable table, const std::filesystem::path& folder, ScenarioMeter& meter);
void read_meter_fault(TomlTable table, Scenario& scenario);

/// One without the other, or lines for the edge about what is not there, would be in vain.
void check_site(TomlTable& root, const Scenario& scenario);

// The tables [[event]] of a scenario file.

void read_event(TomlTable table, Scenario& scenario);

/// Of all of them, in the order of time: refused is what the edge would refuse, what its time
/// cannot do, and what finds nothing to do.
void check_events(TomlTable& root, const Scenario& scenario);

// The tables [[expect]] of a scenario file.

/// Refused is as well what no run could break, and what none could keep.
void read_expectation(TomlTable table, Scenario& scenario);

struct ScenarioPart {
  std::string name;  ///< as [same_without] names it: battery_fault, event 2, edge guard soc_min
  Scenario without;  ///< the scenario, less this part
};

/// In the order of the format; none: nothing goes wrong in it, and all is as usual.
std::vector<ScenarioPart> parts_of(const Scenario& scenario);

/// What such a scenario has instead, by its name in [same_without].
inline constexpr std::string_view kNothing = "nothing";

}  // namespace bess
