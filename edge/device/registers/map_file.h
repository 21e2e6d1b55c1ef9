// Loader of register maps from TOML (format: shared/manual/guides/add_a_battery.md). It proves that
// a map is consistent: names known, blocks contiguous, watchdog fed, power limits expressible.
// Keys besides those of the guide; readers: map_*.cpp here:
//   [map]            kind, baud, parity, stop_bits, connect_delay_ms, minimum_gap_ms,
//                    read_function, address_base, not_implemented, read_gap_registers_max,
//                    registers_per_read_max
//   [[point]]        read_function, unit_group, model, word_order, registers, mask, bits, offset,
//                    scale_divisor, scale_from, percent_of, clamp_to, step, slack, raw_at_max,
//                    unknown, not_implemented, optional, private, storage, max_age_s
//   [response]       settle_s, tolerance_percent, tolerance_w, soc_step_e4, soc_refresh_s,
//                    charges_by_itself
//   [commissioning]  power_w, duration_s, settle_s, tolerance_percent
//   [writes] [exceptions]
//                    eeprom_writes_per_day, reserve; retry, not_permitted
//   [command]        enable, charge, idle, discharge, refresh, precondition, save; of a step:
//                    write, function, read_back, tolerance
//   others           [sunspec] models, bases; [unit_groups]; [[variant]] name; include
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
