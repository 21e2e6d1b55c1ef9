// What a scenario asks of battery, house, meter and market, in the words of bess-sim's command
// line.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// `serial_device`: the battery's end of a line; empty: over TCP. Of a house with steps a file is
/// written.
std::vector<std::string> battery_options(const Scenario& scenario, const std::string& serial_device,
                                         const WorkFolder& folder);

/// On the minute file `prices`. Of day-ahead prices a file is written.
std::vector<std::string> market_options(const Scenario& scenario, const std::string& prices,
                                        const WorkFolder& folder);

}  // namespace bess
