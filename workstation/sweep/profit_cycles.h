// Profit against cycles, a dot a task, as SVG: what a setting earns by trading more, or without.
#pragma once

#include <string>
#include <vector>

#include "workstation/sweep/collected.h"

namespace bess {

/// Empty when no task has figures.
std::string profit_cycles_svg(const std::vector<CollectedTask>& tasks);

}  // namespace bess
