// What a scenario is about, part by part: its faults, each of its events, each row that never
// comes, each step of a price or of the house, each line for the edge, its map and its transport.
// A part without which the run is the same to the bit tests nothing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

struct ScenarioPart {
  std::string name;  ///< as [same_without] names it: battery_fault, event 2, edge guard soc_min
  Scenario without;  ///< the scenario, less this part
};

/// In the order of the format; none: nothing goes wrong in it, and all is as usual.
std::vector<ScenarioPart> parts_of(const Scenario& scenario);

/// What such a scenario has instead, by its name in [same_without].
inline constexpr std::string_view kNothing = "nothing";

}  // namespace bess
