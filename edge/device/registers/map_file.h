// Loader of register maps from TOML (format: shared/manual/guides/add_a_battery.md). It proves that
// a map is consistent: names known, blocks contiguous, watchdog fed, power limits expressible.
#pragma once

#include <string>
#include <string_view>

#include "edge/device/registers/register_map.h"

namespace bess {

/// `variant` selects one of the file's variants; empty = the first. False with one line in `error`.
bool load_register_map(const std::string& path, std::string_view variant, RegisterMap& map,
                       std::string& error);

/// Adds the map's grid point to its measurements; false if it has none.
bool measure_grid_power(RegisterMap& map);

}  // namespace bess
