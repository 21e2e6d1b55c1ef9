// [meter] and [limits]: the house behind the same meter, the limits of its connection, and the
// limits that another program sets. Both are optional; without them nothing is measured or limited.
#pragma once

#include <string>

#include "edge/battery/modbus_wire.h"
#include "edge/registers/register_map.h"
#include "edge/site/site_limits.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {

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

}  // namespace bess
