// [meter] and [limits]: the house behind the same meter, the limits of its connection, and the
// limits that another program sets. Both are optional; without them nothing is measured or limited.
#pragma once

#include "edge/battery/modbus_wire.h"
#include "edge/registers/register_map.h"
#include "edge/site/site_limits.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {

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
