// The battery at the start: is it there, and is it the one that the configuration means? Nothing
// here writes to it, nothing prints.
#pragma once

#include <string>

#include "edge/battery/modbus_battery.h"
#include "edge/program/edge_clock.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Proves that this is the configured battery; else `trouble` says where it was looked for, and
/// what to mend.
Status identify_battery(const EdgeConfig& config, ModbusBattery& battery, std::string& trouble);

/// Tries until `start_timeout_s` is over, or a stop is asked for. kOk when the battery is there and
/// is the right one; otherwise `trouble` is of the last attempt.
Status find_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock,
                    std::string& trouble);

/// A battery that was not found may come later, if the configuration says so; the wrong one stays
/// it.
bool may_start_without(const EdgeConfig& config, Status status);

}  // namespace bess
