// What --check says of the meter: one reading, and the house's load that follows from it.
#pragma once

#include "edge/battery/modbus_meter.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// Reads meter and battery once; true when there is no meter, or it can be read. One line on stdout,
/// or on stderr what to mend.
bool report_site(const EdgeConfig& config, ModbusBattery& battery, ModbusMeter& meter);

}  // namespace bess
