// The operator's settings, from a commented TOML file (bess-edge.toml is the documented example).
// Everything ends in fixed-size structs before the loop starts.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "edge/battery/modbus_wire.h"
#include "edge/log/event_log.h"
#include "edge/loop/control_settings.h"
#include "edge/prices/history_pages.h"
#include "edge/prices/price_feed.h"
#include "edge/registers/register_map.h"
#include "edge/settings/site_config.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Where the controller keeps what outlives it, and where it locks battery and state.
struct StateSettings {
  FixedText<511> folder;
  FixedText<511> run_folder;   ///< on a memory file system, beside `folder`; empty = none
  FixedText<255> lock_folder;  ///< besides the standard one; empty = none
  /// Drives although nothing can be known of what earlier runs left, a trip for one.
  bool drive_without_state = false;
};

struct EdgeConfig {
  ControlSettings control;
  BatteryLinkSettings link;
  PriceFeedSettings price;
  HistorySettings history;
  std::optional<std::int32_t> level_start_centi_eur_per_mwh;
  RegisterMap map;
  ScaledClock clock;
  FixedText<511> map_path;
  StateSettings state;
  EventLogSettings log;
  std::int32_t capacity_wh = 8'000;  ///< what the battery must report, within the tolerance
  std::int32_t capacity_tolerance_percent = 25;
  bool allow_without_watchdog = false;  ///< drive a battery that keeps its order if we die
  std::int32_t start_timeout_s = 10;    ///< wall time to reach the battery at start
  bool start_without_battery = false;   ///< true: keep trying in safe mode instead of exiting
  bool require_synchronised_clock = true;
  SiteConfig site;
};

/// Reads the file and the register map it names. False with one line ("file:line: what, and the
/// mend").
bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error);

/// Path of a file of this name in the [state] folder.
FixedText<639> state_file(const EdgeConfig& config, std::string_view name);
/// In [state] run_folder; empty where there is none.
FixedText<639> run_file(const EdgeConfig& config, std::string_view name);

/// The same file in both folders, for what must be known though one of two disks has died.
struct BothPlaces {
  FixedText<639> state;
  FixedText<639> run;  ///< empty = none
};
BothPlaces both_places(const EdgeConfig& config, std::string_view name);

/// "127.0.0.1:502 unit 85" or "/dev/ttyUSB0 unit 85": where the battery is looked for.
FixedText<159> battery_place(const EdgeConfig& config);

}  // namespace bess
