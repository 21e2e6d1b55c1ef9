// A broken promise of the program itself (edge/base/check.h): the battery gets 0 W and is released
// before the process ends.
#pragma once

#include "edge/battery/modbus_battery.h"

namespace bess {

/// From now on, of this battery, if it is this thread whose check fails. The battery must outlive
/// the process.
void release_if_a_check_fails(ModbusBattery& battery);

}  // namespace bess
