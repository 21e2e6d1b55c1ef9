// Settings of the controller from a TOML file (documented example: bess-edge.toml), in fixed-size
// structs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "edge/app/settings/retired_keys.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/site/site_limits.h"
#include "edge/device/battery/modbus_wire.h"
#include "edge/device/registers/register_map.h"
#include "edge/prices/record/price_settings.h"
#include "edge/records/log/event_log.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"
#include "shared/scaled_clock.h"

namespace bess {

struct SiteConfig {
  SiteSettings settings;
  BatteryLinkSettings link;  ///< of a separate meter
  RegisterMap map;
  FixedText<511> limit_file;
};

struct BatteryConfig {
  FixedText<63> name;  ///< in metrics, topics and titles
  BatteryLinkSettings link;
  RegisterMap map;
  FixedText<511> map_path;
  std::int32_t capacity_wh = 8'000;     ///< the battery must report it within 25 %
  bool allow_without_watchdog = false;  ///< control a battery that keeps its order without us
  std::int32_t start_timeout_s = 10;    ///< wall time to reach the battery at start
};

struct PriceConfig {
  PriceFeedSettings feed;
  HistorySettings history;
  std::optional<std::int32_t> level_start_centi_eur_per_mwh;
};

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

/// "127.0.0.1:502" or the serial device.
FixedText<159> link_place(const BatteryLinkSettings& link);
/// Address of the battery: "127.0.0.1:502 unit 85" or "/dev/ttyUSB0 unit 85".
FixedText<159> battery_place(const BatteryConfig& battery);

// Keys of a configuration without effect, with the reason.

/// "[price] timeout_ms: retired, the value is fixed; delete it".
std::string retired_key_text(const RetiredKey& old);

/// "ramp_w_max: no step is larger than 8000 W".
std::vector<std::string> keys_without_effect(const EdgeConfig& config);

/// Remark on settings, one line.
struct SettingsNote {
  bool is_warning = false;
  std::string text{};
};

/// The weaker transport of url and history_url; a warning if prices could be forged in transit.
SettingsNote transport_note(const PriceConfig& price);

// Readers of sections, for load_edge_config.

void read_limits(TomlTable table, SiteConfig& site);

/// The meter needs another serial line than the battery, or uses its grid power point.
void read_meter(TomlTable table, BatteryConfig& battery, SiteConfig& site);

/// Power and operator's settings of the battery go to `control`.
void read_battery(TomlTable table, BatteryConfig& battery, ControlSettings& control);

/// Rejects a power that the map cannot express.
void check_battery_against_map(TomlTable table, const BatteryConfig& battery,
                               const ControlSettings& control);

/// Sets the supervision by map and rating of the battery.
void set_supervision(const BatteryConfig& battery, ControlSettings& control);

/// [guard]. Call after read_battery: the default of cycles_per_day_max depends on power and
/// capacity.
void read_guard(TomlTable table, const BatteryConfig& battery, ControlSettings& control);

/// [[reserve]], an array of tables; bounds and hysteresis of the guard must be known.
void read_reserve(TomlTable& root, ControlSettings& control);

/// Rejects a full charge that soc_max forbids, which would never end.
void check_full_charge(TomlTable& battery, const ControlSettings& control);

/// Source of day-ahead prices, for a student whose context is the outlook.
void read_outlook(TomlTable table, OutlookSettings& outlook);

void read_price(TomlTable table, PriceConfig& price);

/// Keeps the path of the key, relative to the folder of the file.
template <int kCapacity>
void keep_resolved(TomlTable& table, std::string_view key, std::string_view path,
                   FixedText<kCapacity>& kept) {
  if (!kept.assign(table.resolved(path))) table.fail(key, "is too long a path");
}

// Keys of a price server, the same in [price] and [outlook].

/// Operator's settings of the transport.
struct PriceTransportKeys {
  bool allow_http = false;
  FixedText<255> header_file;  ///< secrets that are sent with every request; empty = none
};

void read_price_server(TomlTable& table, HttpSettings& http, PriceFields& fields,
                       PriceTransportKeys& keys);

/// Rejects a malformed URL, plain HTTP that is not allowed, and secrets over plain HTTP.
void check_price_url(TomlTable& table, std::string_view key, std::string_view url,
                     const PriceTransportKeys& keys);

/// Loads the header file, if any, after all other checks.
void load_headers(TomlTable& table, const PriceTransportKeys& keys, HttpSettings& http);

}  // namespace bess
