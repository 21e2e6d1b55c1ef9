// The operator's settings, from a commented TOML file (bess-edge.toml is the documented example).
// Everything ends in fixed-size structs before the loop starts.
#pragma once

#include <string>
#include <string_view>

#include "edge/app/settings/control_config.h"
#include "edge/app/settings/price_config.h"
#include "edge/app/settings/retired_keys.h"
#include "edge/records/log/event_log.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"
#include "shared/scaled_clock.h"

namespace bess {

// [state], [log] and [metrics]: what the controller keeps, and where; and the paths below.

/// Where the controller keeps what outlives it.
struct StateSettings {
  FixedText<511> folder;
  FixedText<511> run_folder;  ///< on a memory file system, beside `folder`; empty = none
};

/// The log lies in the [state] folders, unless it is said otherwise.
struct KeptFiles {
  StateSettings& state;
  EventLogSettings& log;
};
void read_state(TomlTable table, KeptFiles kept);
void read_log(TomlTable table, EventLogSettings& log);
void read_metrics(TomlTable table, EventLogSettings& log);

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
  FixedText<159> contact;  ///< who is called when it does not work; empty = not said
};

/// Reads the file and the register map it names. False with one line ("file:line: what, and the
/// mend").
bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error);

/// Path of a file of this name in the [state] folder.
FixedText<639> state_file(const EdgeConfig& config, std::string_view name);
/// In [state] run_folder; empty where there is none.
FixedText<639> run_file(const EdgeConfig& config, std::string_view name);

/// The record of bess-prices: in the run folder, or in /dev/shm where there is none.
FixedText<639> prices_file(const EdgeConfig& config);

/// Of the usual time at which tomorrow's prices are asked for: 0 to 119 s, the same at every start,
/// so that a thousand machines do not ask at one instant; 0 in simulated time.
std::int32_t day_ahead_offset_s(const EdgeConfig& config);

/// The same file in both folders, for what must be known though one of two disks has died.
struct BothPlaces {
  FixedText<639> state;
  FixedText<639> run;  ///< empty = none
};
BothPlaces both_places(const EdgeConfig& config, std::string_view name);

}  // namespace bess
