// [battery], [guard], [[reserve]], [outlook], [meter], [connection] and [limits] of the
// configuration: what the controller drives, its bounds, and its site.
#pragma once

#include <cstdint>
#include <string>

#include "edge/core/loop/control_settings.h"
#include "edge/core/site/site_limits.h"
#include "edge/device/battery/modbus_wire.h"
#include "edge/device/registers/register_map.h"
#include "edge/prices/record/price_settings.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {

// [meter] and [limits]: the house behind the same meter, the limits of its connection, and the
// limits that another program sets. Both are optional; without them nothing is measured or limited.

// The keys of a Modbus connection and of the register map behind it: the same in [battery] and
// [meter].

/// transport, host, port, device, baud, parity, stop_bits, unit, response_timeout_ms; units is
/// asked for, and read by load_linked_map. To be called before `finish`.
void read_link(TomlTable& table, BatteryLinkSettings& link);

/// What cannot be a connection; to be called after `finish`.
void check_link(TomlTable& table, const BatteryLinkSettings& link);

/// Loads the map that the table names, relative to its file, and completes `link` by what its maker
/// ships. `path` is the map's. False with the table's error set.
bool load_linked_map(TomlTable& table, std::string_view map_file, std::string_view variant,
                     BatteryLinkSettings& link, RegisterMap& map, FixedText<511>& path);

struct SiteConfig {
  SiteSettings settings;
  BatteryLinkSettings link;  ///< of a meter with a map of its own
  RegisterMap map;
  FixedText<511> limit_file;
};

/// What a meter shares with the battery: its serial line must be another one, its grid point may be
/// what is read.
struct MeteredBattery {
  const BatteryLinkSettings& link;
  RegisterMap& map;
};

void read_meter(TomlTable table, MeteredBattery battery, SiteConfig& site);
void read_limits(TomlTable table, SiteConfig& site);

struct BatteryConfig {
  FixedText<63> name;  ///< in metrics, topics and titles
  BatteryLinkSettings link;
  RegisterMap map;
  FixedText<511> map_path;
  std::int32_t capacity_wh = 8'000;     ///< what the battery must report, within a quarter
  bool allow_without_watchdog = false;  ///< drive a battery that keeps its order if we die
  std::int32_t start_timeout_s = 10;    ///< wall time to reach the battery at start
};

/// Its power and what people ask of it go to the control loop.
void read_battery(TomlTable table, BatteryConfig& battery, ControlSettings& control);

/// A power that the map cannot express must stop the start.
void check_battery_against_map(TomlTable table, const BatteryConfig& battery,
                               const ControlSettings& control);

/// What counts as an answer of this battery, by its map and its rating.
void set_supervision(const BatteryConfig& battery, ControlSettings& control);

/// "127.0.0.1:502 unit 85" or "/dev/ttyUSB0 unit 85": where the battery is looked for.
FixedText<159> battery_place(const BatteryConfig& battery);

// [guard]: what no order may break, and how much a day may wear the battery.

/// `battery`, and its power in `control`, must be known: what a day may hold follows from both.
void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control);

// What an operator decides besides trading: a reserve by the hour, full charges.

/// Key full_charge_every_days of [battery]; power_w must be known.
void read_full_charge(TomlTable& battery, ControlSettings& control);

/// [[reserve]], an array of tables; bounds and hysteresis of the guard must be known.
void read_reserve(TomlTable& root, ControlSettings& control);

/// A full charge that soc_max forbids would be tried for ever.
void check_full_charge(TomlTable& battery, const ControlSettings& control);

// [outlook]: whom to ask for day-ahead prices, for a student whose context is the outlook.

void read_outlook(TomlTable table, OutlookSettings& outlook);

}  // namespace bess
