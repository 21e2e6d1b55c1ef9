// Retired keys of earlier versions. A configuration with them still works, and --check and status
// name them.
#pragma once

#include <string_view>

#include "edge/core/base/static_vector.h"
#include "shared/host/toml_reader.h"

namespace bess {

struct RetiredKey {
  std::string_view section;
  std::string_view key;
  std::string_view instead = "the value is fixed";
};
using RetiredKeys = StaticVector<RetiredKey, 48>;

inline constexpr std::string_view kInStatement = "see bess-train log statement --config";
inline constexpr std::string_view kInBatteryName = "set [battery] name";
inline constexpr std::string_view kInCommand = "alerts go to [notify] command or MQTT";

inline constexpr RetiredKey kRetiredKeys[] = {
    {"battery", "capacity_tolerance_percent"},
    {"battery", "full_charge_power"},
    {"battery", "read_lead_s"},
    {"battery", "start_without_battery"},
    {"price", "frozen_price_s"},
    {"price", "history_wait_s"},
    {"price", "hold_flagged_step"},
    {"price", "requests_per_cycle"},
    {"price", "resolve_every_s"},
    {"price", "step_flag_eur_per_mwh"},
    {"price", "timeout_ms"},
    {"price", "wait_s"},
    {"outlook", "ask_spread_s"},
    {"outlook", "timeout_ms"},
    {"guard", "hold_s"},
    {"guard", "order_deadline_s"},
    {"guard", "require_synchronised_clock"},
    {"guard", "soc_hysteresis"},
    {"guard", "start_spread_s"},
    {"state", "drive_without_state"},
    {"state", "lock_folder"},
    {"meter", "age_s_max"},
    {"meter", "check_every_s"},
    {"meter", "house_rise_w"},
    {"contract", "import_adder_eur_per_mwh", kInStatement},
    {"contract", "import_percent", kInStatement},
    {"contract", "export_fee_eur_per_mwh", kInStatement},
    {"contract", "export_percent", kInStatement},
    {"contract", "wear_eur_per_mwh", kInStatement},
    {"notify", "mqtt_discovery_prefix"},
    {"notify", "mqtt_hold_minutes"},
    {"notify", "node", kInBatteryName},
    {"notify", "mail_to", kInCommand},
    {"notify", "mail_from", kInCommand},
    {"notify", "sendmail", kInCommand},
    {"notify", "webhook_url", kInCommand},
    {"notify", "webhook_header_file", kInCommand},
    {"notify", "webhook_ca_file", kInCommand},
    {"page", "name", kInBatteryName},
    {"page", "program"},
    {"page", "refresh_s"},
    {"page", "token_file", "the page is read-only"},
    {"settled", "days"},
};
static_assert(std::ssize(kRetiredKeys) <= RetiredKeys::capacity());

/// Section of the configuration without its retired keys, which `retired` collects.
inline TomlTable section(TomlTable& root, std::string_view name, RetiredKeys* retired = nullptr) {
  TomlTable table = root.child(name);
  for (const RetiredKey& old : kRetiredKeys) {
    if (old.section != name || !table.take_retired(old.key) || retired == nullptr) continue;
    static_cast<void>(retired->try_push_back(old));
  }
  return table;
}

}  // namespace bess
