// What --check says of what the operator asks: each line only where there is one.
#pragma once

#include <string>

#include "edge/control/hold.h"
#include "edge/loop/control_settings.h"

namespace bess {

/// Lines with their ends; empty when nothing is wanted. `now_utc_s` decides which reserve and hold
/// are in force.
std::string operator_note(const ControlSettings& control, const Hold& hold, std::int64_t now_utc_s);

}  // namespace bess
