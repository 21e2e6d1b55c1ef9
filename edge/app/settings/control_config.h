// Readers of [battery], [guard], [[reserve]], [outlook], [meter] and [limits] of the configuration.
#pragma once

#include <cstdint>

#include "edge/core/loop/control_settings.h"
#include "edge/core/site/site_limits.h"
#include "edge/device/battery/modbus_wire.h"
#include "edge/device/registers/register_map.h"
#include "edge/prices/record/price_settings.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct SiteConfig {
  SiteSettings settings;
  BatteryLinkSettings link;  ///< of a separate meter
  RegisterMap map;
  FixedText<511> limit_file;
};

void read_limits(TomlTable table, SiteConfig& site);

struct BatteryConfig {
  FixedText<63> name;  ///< in metrics, topics and titles
  BatteryLinkSettings link;
  RegisterMap map;
  FixedText<511> map_path;
  std::int32_t capacity_wh = 8'000;     ///< the battery must report it within 25 %
  bool allow_without_watchdog = false;  ///< control a battery that keeps its order without us
  std::int32_t start_timeout_s = 10;    ///< wall time to reach the battery at start
};

/// The meter needs another serial line than the battery, or uses its grid power point.
void read_meter(TomlTable table, BatteryConfig& battery, SiteConfig& site);

/// Power and operator's settings of the battery go to `control`.
void read_battery(TomlTable table, BatteryConfig& battery, ControlSettings& control);

/// Rejects a power that the map cannot express.
void check_battery_against_map(TomlTable table, const BatteryConfig& battery,
                               const ControlSettings& control);

/// Sets the supervision by map and rating of the battery.
void set_supervision(const BatteryConfig& battery, ControlSettings& control);

/// "127.0.0.1:502" or the serial device.
FixedText<159> link_place(const BatteryLinkSettings& link);
/// Address of the battery: "127.0.0.1:502 unit 85" or "/dev/ttyUSB0 unit 85".
FixedText<159> battery_place(const BatteryConfig& battery);

/// [guard]. Call after read_battery: the default of cycles_per_day_max depends on power and
/// capacity.
void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control);

/// [[reserve]], an array of tables; bounds and hysteresis of the guard must be known.
void read_reserve(TomlTable& root, ControlSettings& control);

/// Rejects a full charge that soc_max forbids, which would never end.
void check_full_charge(TomlTable& battery, const ControlSettings& control);

/// Source of day-ahead prices, for a student whose context is the outlook.
void read_outlook(TomlTable table, OutlookSettings& outlook);

}  // namespace bess
