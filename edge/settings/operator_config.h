// What an operator decides besides trading: a reserve by the hour, full charges, the spread of the
// starts.
#pragma once

#include "edge/loop/control_settings.h"
#include "shared/host/toml_reader.h"

namespace bess {

/// Keys full_charge_every_days and full_charge_power of [battery]; power_w must be known.
void read_full_charge(TomlTable& battery, ControlSettings& control);

/// [[reserve]], an array of tables; bounds and hysteresis of the guard must be known.
void read_reserve(TomlTable& root, ControlSettings& control);

/// Key start_spread_s of [guard]; `place`: of the battery, which the start is drawn by.
void read_start_spread(TomlTable& guard, std::string_view place, ControlSettings& control);

/// A full charge that soc_max forbids would be tried for ever.
void check_full_charge(TomlTable& battery, const ControlSettings& control);

}  // namespace bess
