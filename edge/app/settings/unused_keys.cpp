#include "edge/app/settings/edge_config.h"

#include "shared/host/text.h"

namespace bess {
namespace {

constexpr int kCyclesPerHour = 30;

/// Maximum of this battery in a day of 25 hours, in 1e-4 full cycles.
std::int64_t cycles_per_day_possible_e4(const EdgeConfig& config) {
  if (config.battery.capacity_wh <= 0) return 0;
  return std::int64_t{25} * 10'000 * config.control.guard.power_w /
         (2 * config.battery.capacity_wh);
}

void add_guard(const EdgeConfig& config, std::vector<std::string>& keys) {
  const ControlSettings& control = config.control;
  const GuardSettings& guard = control.guard;
  if (!control.control) {
    keys.emplace_back("all limits: with control = false nothing is written to the battery");
  }
  if (guard.ramp_w_max >= 2 * guard.power_w) {
    keys.emplace_back(formatted("ramp_w_max: no step is larger than %d W", 2 * guard.power_w));
  }
  if (control.cycles_per_day_max_e4 > cycles_per_day_possible_e4(config)) {
    keys.emplace_back(formatted("cycles_per_day_max: this battery reaches %.1f full cycles a day",
                                static_cast<double>(cycles_per_day_possible_e4(config)) / 10'000));
  }
  if (control.reversals_per_hour_max >= kCyclesPerHour) {
    keys.emplace_back("reversals_per_hour_max: an hour has 30 control cycles");
  }
}

void add_reserves(const EdgeConfig& config, std::vector<std::string>& keys) {
  const std::int32_t soc_min_e4 = config.control.guard.soc_min_e4;
  for (const ReservePeriod& period : config.control.reserve) {
    if (period.soc_e4 > soc_min_e4) continue;
    keys.emplace_back(formatted("reserve of %.1f %%: soc_min always keeps %.1f %%",
                                period.soc_e4 / 100.0, soc_min_e4 / 100.0));
  }
}

void add_site(const EdgeConfig& config, std::vector<std::string>& keys) {
  const SiteSettings& site = config.site.settings;
  if (site.meter == MeterSource::kNone) return;
  const ConnectionSettings& connection = site.connection;
  const bool has_limit = connection.import_w_max < kAnyPowerW ||
                         connection.export_w_max < kAnyPowerW || connection.peak_w_max < kAnyPowerW;
  if (!has_limit) {
    keys.emplace_back("[meter]: sets no limit (import_w_max, export_w_max, peak_w_max)");
  }
  if (connection.peak_w_max < kAnyPowerW && connection.import_w_max < kAnyPowerW &&
      connection.peak_w_max >= connection.import_w_max) {
    keys.emplace_back("peak_w_max: import_w_max is always lower");
  }
}

}  // namespace

std::string retired_key_text(const RetiredKey& old) {
  return "[" + std::string(old.section) + "] " + std::string(old.key) + ": retired, " +
         std::string(old.instead) + "; delete it";
}

std::vector<std::string> keys_without_effect(const EdgeConfig& config) {
  std::vector<std::string> keys;
  for (const RetiredKey& old : config.retired) keys.push_back(retired_key_text(old));
  add_guard(config, keys);
  add_reserves(config, keys);
  add_site(config, keys);
  return keys;
}

}  // namespace bess
