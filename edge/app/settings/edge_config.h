// Settings of the controller from a TOML file (documented example: bess-edge.toml), in fixed-size
// structs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "edge/app/settings/control_config.h"
#include "edge/app/settings/price_config.h"
#include "edge/app/settings/retired_keys.h"
#include "edge/records/log/event_log.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Folders of the persistent state.
struct StateSettings {
  FixedText<511> folder;
  FixedText<511> run_folder;  ///< on a memory file system; empty = none
};

struct EdgeConfig {
  ControlSettings control;
  BatteryConfig battery;
  PriceConfig price;
  OutlookSettings outlook;
  SiteConfig site;
  StateSettings state;
  EventLogSettings log;
  ScaledClock clock;
  RetiredKeys retired;
  FixedText<159> contact;  ///< person to call; empty = none
};

/// Reads the file and its register map. False with one line ("file:line: error, remedy").
bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error);

/// Path of a file of this name in the [state] folder.
FixedText<639> state_file(const EdgeConfig& config, std::string_view name);
/// In [state] run_folder; empty without one.
FixedText<639> run_file(const EdgeConfig& config, std::string_view name);

/// Price record of bess-prices: in the run folder, else in /dev/shm.
FixedText<639> prices_file(const EdgeConfig& config);

/// Delay of the first request for tomorrow's prices, 0 to 119 s, constant per machine, to spread
/// the requests of many machines; 0 in simulated time.
std::int32_t day_ahead_offset_s(const EdgeConfig& config);

/// The same file in both folders, for state that must survive the failure of one.
struct StateFilePaths {
  FixedText<639> state;
  FixedText<639> run;  ///< empty = none
};
StateFilePaths state_file_paths(const EdgeConfig& config, std::string_view name);

// Keys of a configuration without effect, with the reason.

/// "[price] timeout_ms: retired, ...".
std::string retired_key_text(const RetiredKey& old);

/// "ramp_w_max: no step is larger than 8000 W".
std::vector<std::string> keys_without_effect(const EdgeConfig& config);

}  // namespace bess
