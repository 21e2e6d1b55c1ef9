#include "edge/app/settings/edge_config.h"

#include <unistd.h>

#include <filesystem>
#include <string>

#include "edge/prices/record/published_prices.h"
#include "edge/records/log/battery_name.h"
#include "shared/crc32.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

template <int kCapacity>
void keep_path(TomlTable& table, std::string_view key, const std::string& path,
               FixedText<kCapacity>& kept) {
  if (!kept.assign(path)) table.fail(key, "is too long");
}

void keep_folder(TomlTable& table, std::string_view key, const std::string& path,
                 FixedText<511>& folder, FixedText<511>& ring, FixedText<511>& status,
                 FixedText<511>& metrics) {
  keep_path(table, key, path, folder);
  keep_path(table, key, path + "/decisions.ring", ring);
  keep_path(table, key, path + "/status.json", status);
  keep_path(table, key, path + "/metrics.prom", metrics);
}

/// The log is in the [state] folders by default.
void read_state(TomlTable table, StateSettings& state, EventLogSettings& log) {
  FixedText<255> folder("state");
  table.text("folder", folder);
  if (folder.empty()) table.fail("folder", "must not be empty");
  const std::string path = table.resolved(folder.view());
  // Default only for the service: otherwise no memory folder is known.
  FixedText<255> run_folder(kInstalledEdge.run_beside(path));
  table.text("run_folder", run_folder);
  table.finish();
  if (!run_folder.empty()) {
    keep_folder(table, "run_folder", table.resolved(run_folder.view()), state.run_folder,
                log.run_ring, log.run_status, log.run_metrics);
  }
  keep_folder(table, "folder", path, state.folder, log.ring, log.status, log.metrics);
}

void read_log(TomlTable table, EventLogSettings& log) {
  FixedText<255> csv;
  table.text("csv", csv);
  table.integer("days", log.ring_days, 1, 3'660);
  table.finish();
  if (!csv.empty()) keep_path(table, "csv", table.resolved(csv.view()), log.csv);
}

void read_metrics(TomlTable table, EventLogSettings& log) {
  FixedText<255> prometheus;
  table.text("prometheus", prometheus);
  table.finish();
  if (!prometheus.empty()) {
    keep_path(table, "prometheus", table.resolved(prometheus.view()), log.metrics);
  }
}

/// Completes the site's settings from battery and map.
void set_site(EdgeConfig& config) {
  SiteSettings& site = config.site.settings;
  site.meter_check.power_w = config.control.guard.power_w;
  site.meter_check.settle_s = config.battery.map.response.settle_s;
  // A hybrid inverter has panels of unknown power.
  if (config.battery.map.response.charges_by_itself && site.pv_w_max == 0)
    site.pv_w_max = kAnyPowerW;
}

void read_simulation(TomlTable table, ScaledClock& clock) {
  FixedText<31> utc_start;
  std::int32_t scale = 1;
  std::int64_t anchor_ns = 0;
  table.integer("time_scale", scale, 1, 100'000);
  table.text("utc_start", utc_start);
  table.integer("anchor_monotonic_ns", anchor_ns, 0, INT64_MAX);
  table.finish();
  if (table.value() == nullptr) return;
  clock.scale = scale;
  clock.anchor_monotonic_ns = anchor_ns != 0 ? anchor_ns : clock_ns(CLOCK_MONOTONIC);
  table.require("utc_start");
  if (table.ok() && !parse_utc(utc_start.view(), clock.anchor_utc_s)) {
    table.fail("utc_start", "must be a UTC time such as \"2023-03-26T00:00:00Z\"");
  }
}

}  // namespace

bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  root.boolean("control", config.control.control);
  root.text("contact", config.contact);
  root.require("price");
  read_battery(section(root, "battery", &config.retired), config.battery, config.control);
  check_battery_against_map(section(root, "battery"), config.battery, config.control);
  read_price(section(root, "price", &config.retired), config.price);
  read_outlook(section(root, "outlook", &config.retired), config.outlook);
  read_guard(section(root, "guard", &config.retired), config.battery, config.control);
  read_reserve(root, config.control);
  TomlTable battery = section(root, "battery");
  check_full_charge(battery, config.control);
  read_state(section(root, "state", &config.retired), config.state, config.log);
  read_log(section(root, "log"), config.log);
  read_metrics(section(root, "metrics"), config.log);
  read_simulation(section(root, "simulation"), config.clock);
  read_meter(section(root, "meter", &config.retired), config.battery, config.site);
  read_limits(section(root, "limits"), config.site);
  // For bess-notify, bess-page and bess-edge earned: an error there must not stop the controller.
  for (const char* const others : {"notify", "page", "settled", "contract"}) {
    static_cast<void>(section(root, others, &config.retired));
  }
  root.finish();
  if (config.battery.name.empty()) {
    config.battery.name = std::string_view(default_battery_name(config.state.folder.c_str()));
  }
  config.control.price_wait_s = kPriceWait_s;
  set_supervision(config.battery, config.control);
  set_site(config);
  if (config.battery.map.watchdog.duration_s > 0) {
    config.control.order_duration_s = config.battery.map.watchdog.duration_s;
    config.control.has_watchdog = true;
  }
  return error.empty();
}

namespace {

FixedText<639> file_in(const char* folder, std::string_view name) {
  return std::string(folder).append("/").append(name).c_str();
}

}  // namespace

FixedText<639> state_file(const EdgeConfig& config, std::string_view name) {
  return file_in(config.state.folder.c_str(), name);
}

FixedText<639> run_file(const EdgeConfig& config, std::string_view name) {
  if (config.state.run_folder.empty()) return {};
  return file_in(config.state.run_folder.c_str(), name);
}

FixedText<639> prices_file(const EdgeConfig& config) {
  const FixedText<639> run = run_file(config, kPricesFileName);
  if (!run.empty()) return run;
  // In memory, independent of the disk; named by user and state folder.
  std::error_code ignored;
  const std::string folder =
      std::filesystem::absolute(config.state.folder.c_str(), ignored).lexically_normal().string();
  return formatted("/dev/shm/bess-%u-%08x.prices", static_cast<unsigned>(getuid()),
                   crc32_of(folder.data(), folder.size()))
      .c_str();
}

std::int32_t day_ahead_offset_s(const EdgeConfig& config) {
  constexpr std::int32_t kSpread_s = 120;
  if (!config.clock.is_real_time()) return 0;
  const std::string id = battery_id(config.state.folder.c_str());
  return static_cast<std::int32_t>(crc32_of(id.data(), id.size()) % kSpread_s);
}

StateFilePaths state_file_paths(const EdgeConfig& config, std::string_view name) {
  return {.state = state_file(config, name), .run = run_file(config, name)};
}

}  // namespace bess
