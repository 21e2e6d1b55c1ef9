// What an operator decides besides trading: a reserve by the hour, full charges.
#pragma once

#include "edge/loop/control_settings.h"
#include "shared/host/toml_reader.h"

namespace bess {

/// Key full_charge_every_days of [battery]; power_w must be known.
void read_full_charge(TomlTable& battery, ControlSettings& control);

/// [[reserve]], an array of tables; bounds and hysteresis of the guard must be known.
void read_reserve(TomlTable& root, ControlSettings& control);

/// A full charge that soc_max forbids would be tried for ever.
void check_full_charge(TomlTable& battery, const ControlSettings& control);

}  // namespace bess
