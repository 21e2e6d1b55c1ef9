#include "edge/settings/edge_config.h"
#include "edge/log/installed_folders.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "edge/prices/http_secrets.h"
#include "edge/registers/codec.h"
#include "edge/settings/link_config.h"
#include "edge/settings/people_config.h"
#include "edge/settings/price_transport.h"
#include "shared/host/toml_reader.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

TomlTable section(TomlTable& root, std::string_view name) {
  return {root.table(name), root.file(), std::string("[").append(name).append("]"), root.error()};
}

struct CapacityRange {
  std::int64_t least_wh;
  std::int64_t most_wh;
};

/// What a battery of the configured capacity reports.
CapacityRange capacity_range(const EdgeConfig& config) {
  const std::int64_t capacity_wh = config.capacity_wh;
  const std::int64_t tolerance_wh = capacity_wh * config.capacity_tolerance_percent / 100;
  return {.least_wh = capacity_wh - tolerance_wh, .most_wh = capacity_wh + tolerance_wh};
}

/// The battery must report the configured capacity, else the address leads to another one.
void expect_capacity(EdgeConfig& config) {
  const CapacityRange range = capacity_range(config);
  for (IdentityCheck& check : config.map.identity) {
    if (config.map.points[check.point].name != "capacity") continue;
    check.value_min = range.least_wh;
    check.value_max = range.most_wh;
    check.hint = "is [battery] capacity_wh right, or is this another battery?";
  }
}

/// What counts as an answer of this battery, by its map and its rating.
void set_supervision(EdgeConfig& config) {
  SupervisionSettings& supervision = config.control.supervision;
  supervision.response = {.band = config.map.response,
                          .power_w = config.control.guard.power_w,
                          .capacity_wh = config.capacity_wh};
  const CapacityRange range = capacity_range(config);
  supervision.capacity_wh_min = static_cast<std::int32_t>(range.least_wh);
  supervision.capacity_wh_max = static_cast<std::int32_t>(range.most_wh);
}

/// What the meter is held against: this battery's steps.
void set_site(EdgeConfig& config) {
  SiteSettings& site = config.site.settings;
  site.witness.power_w = config.control.guard.power_w;
  site.witness.settle_s = config.map.response.settle_s;
  // A hybrid inverter has panels of its own, and its map does not know how large they are.
  if (config.map.response.charges_by_itself && site.pv_w_max == 0) site.pv_w_max = kAnyPowerW;
}

void read_battery(TomlTable table, EdgeConfig& config) {
  FixedText<255> map_file("maps/alphaess.toml");
  RegisterName variant;
  table.text("map", map_file);
  table.text("variant", variant);
  read_link(table, config.link);
  table.integer("power_w", config.control.guard.power_w, 1, 100'000'000);
  table.integer("capacity_wh", config.capacity_wh, 1, 1'000'000'000);
  table.integer("capacity_tolerance_percent", config.capacity_tolerance_percent, 0, 100);
  table.integer("start_timeout_s", config.start_timeout_s, 0, 3'600);
  table.boolean("allow_without_watchdog", config.allow_without_watchdog);
  table.boolean("start_without_battery", config.start_without_battery);
  table.integer("read_lead_s", config.control.read_lead_s, 0, 60);
  int on_other_master = 0;
  table.choice("on_other_master", on_other_master, {"yield", "insist"});
  config.control.supervision.yields_to_other_master = on_other_master == 0;
  read_full_charge(table, config.control);
  table.finish();
  check_link(table, config.link);
  if (!load_linked_map(table, map_file.view(), variant.view(), config.link, config.map,
                       config.map_path)) {
    return;
  }
  if (config.map.is_meter) return table.fail("map", "is a meter's: it belongs into [meter]");
  expect_capacity(config);
}

/// A power that the map cannot express must stop the start.
void check_battery_against_map(TomlTable table, EdgeConfig& config) {
  if (!table.ok()) return;
  const std::int32_t power_w = config.control.guard.power_w;
  if (power_w > config.map.charge_w_max || power_w > config.map.discharge_w_max) {
    table.fail("power_w", "= " + std::to_string(power_w) + " is more than the map " +
                              std::string(config.map.name.view()) + " can express (charge " +
                              std::to_string(config.map.charge_w_max) + " W, discharge " +
                              std::to_string(config.map.discharge_w_max) + " W)");
  }
  if (config.control.control && config.map.watchdog.duration_s == 0 &&
      !config.allow_without_watchdog) {
    table.fail("variant",
               "\"" + std::string(config.map.variant.view()) + "\" of map " +
                   std::string(config.map.name.view()) +
                   " has no watchdog: if bess-edge dies, the battery follows its last order for "
                   "ever; choose another variant, or add allow_without_watchdog = true");
  }
}

bool is_http(std::string_view url) {
  return url.starts_with("http://") || url.starts_with("https://");
}

/// How a student by level is given the level at a first start.
void read_history(TomlTable& table, EdgeConfig& config) {
  HistorySettings& history = config.history;
  table.integer("history_hours", history.hours, 0, PriceHistory::kHoursMax);
  table.integer("history_wait_s", history.wait_s, 1, 3'600);
  table.text("history_url", history.url);
  if (table.has("level_start_eur_per_mwh")) {
    std::int32_t start_centi_eur_per_mwh = 0;
    table.scaled("level_start_eur_per_mwh", start_centi_eur_per_mwh, kCentiPerEur,
                 kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
    config.level_start_centi_eur_per_mwh = start_centi_eur_per_mwh;
  }
}

/// Names are looked up, and secrets sent, for one host alone.
void check_history_url(TomlTable& table, const EdgeConfig& config) {
  const FixedText<511>& url = config.history.url;
  if (url.empty()) return;
  HostAddresses here;
  HostAddresses there;
  const bool is_known = here.set_url(config.price.http.url.c_str()) == Status::kOk &&
                        there.set_url(url.c_str()) == Status::kOk;
  if (!is_http(url.view()) || !is_known || !there.is_same_host(here)) {
    table.fail("history_url", "must start with http:// or https:// and be of the host of url");
  }
}

void read_price(TomlTable table, EdgeConfig& config) {
  PriceFeedSettings& price = config.price;
  FixedText<255> header_file;
  PriceTransportKeys transport;
  table.require("url");
  table.text("url", price.http.url);
  table.text("ca_file", price.http.ca_file);
  table.text("header_file", header_file);
  table.text("rows_field", price.fields.rows);
  table.text("time_field", price.fields.time);
  table.text("price_field", price.fields.price);
  table.integer("timeout_ms", price.http.timeout_ms, 10, 60'000);
  table.integer("resolve_every_s", price.http.resolve_every_s, 1, 86'400);
  table.integer("requests_per_cycle", price.requests_per_cycle, 1, 4);
  table.integer("wait_s", price.wait_s, 1, 60);
  table.scaled("step_flag_eur_per_mwh", price.step_flag_centi_eur_per_mwh, kCentiPerEur, 0,
               2 * kPlausiblePriceMaxEurPerMwh);
  table.integer("frozen_price_s", config.control.frozen_price.told_s, 0, 86'400);
  read_history(table, config);
  table.boolean("allow_http", transport.allow_http);
  table.boolean("hold_flagged_step", price.hold_flagged_step);
  table.finish();
  if (!table.ok()) return;
  const std::string_view url = price.http.url.view();
  check_history_url(table, config);
  transport.has_header_file = !header_file.empty();
  check_price_transport(table, {price, config.history}, transport);
  const std::string ca_file = table.resolved(price.http.ca_file.view());
  if (!price.http.ca_file.assign(ca_file)) table.fail("ca_file", "is too long a path");
  if (url.starts_with("https://") && access(price.http.ca_file.c_str(), R_OK) != 0) {
    table.fail("ca_file", "= " + ca_file +
                              " cannot be read: install the package ca-certificates, "
                              "or name your own file");
  }
  if (header_file.empty() || !table.ok()) return;
  load_http_headers(table.resolved(header_file.view()).c_str(), price.http.headers, table.error());
}

/// In whole EUR/MWh, as the proof counts them: 1500 as well as 1500.0.
void read_threshold(TomlTable& table, std::string_view key, std::int32_t& eur_per_mwh) {
  std::int32_t centi_eur_per_mwh = eur_per_mwh * kCentiPerEur;
  table.scaled(key, centi_eur_per_mwh, kCentiPerEur, -kThresholdMaxEurPerMwh,
               kThresholdMaxEurPerMwh);
  if (centi_eur_per_mwh % kCentiPerEur != 0) {
    table.fail(key, "must be whole EUR/MWh, as the student is proved for");
  }
  eur_per_mwh = centi_eur_per_mwh / kCentiPerEur;
}

/// Twelve for a battery that is full in an hour, fewer for a slower one: what honest prices have
/// needed.
std::int32_t default_cycles_per_day_e4(const EdgeConfig& config) {
  const std::int64_t cycles_e4 =
      std::int64_t{120'000} * config.control.guard.power_w / config.capacity_wh;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(cycles_e4, 10'000, 1'000'000));
}

void read_guard(TomlTable table, EdgeConfig& config) {
  GuardSettings& guard = config.control.guard;
  read_threshold(table, "low_price_eur_per_mwh", guard.thresholds.low_eur_per_mwh);
  read_threshold(table, "high_price_eur_per_mwh", guard.thresholds.high_eur_per_mwh);
  table.scaled("soc_min", guard.soc_min_e4, 10'000, 0, 1);
  table.scaled("soc_max", guard.soc_max_e4, 10'000, 0, 1);
  table.scaled("soc_hysteresis", guard.soc_hysteresis_e4, 10'000, 0, 0.2);
  table.integer("price_age_s_max", guard.price_age_s_max, 60, 1'800);
  table.integer("frozen_price_s_max", config.control.frozen_price.stop_s, 0, 86'400);
  table.scaled("temperature_min_c", guard.temperature_min_deci_c, 10, -50, 100);
  table.scaled("temperature_max_c", guard.temperature_max_deci_c, 10, -50, 100);
  table.integer("hold_s", config.control.hold_s, 0, 3'600);
  table.integer("ramp_w_max", guard.ramp_w_max, 0, 100'000'000);
  config.control.cycles_per_day_max_e4 = default_cycles_per_day_e4(config);
  table.scaled("cycles_per_day_max", config.control.cycles_per_day_max_e4, 10'000, 0, 100);
  table.integer("reversals_per_hour_max", config.control.reversals_per_hour_max, 0, kStepsPerHour);
  table.integer("order_deadline_s", config.control.order_deadline_s, 1, kSecondsPerStep);
  table.boolean("require_synchronised_clock", config.require_synchronised_clock);
  read_start_spread(table, battery_place(config).view(), config.control);
  table.finish();
  if (!guard.thresholds.are_ordered()) {
    table.fail("low_price_eur_per_mwh", "must be below high_price_eur_per_mwh");
  }
  if (guard.soc_min_e4 + 2 * guard.soc_hysteresis_e4 >= guard.soc_max_e4) {
    table.fail("soc_min", "must be below soc_max by more than twice soc_hysteresis");
  }
  if (guard.temperature_min_deci_c >= guard.temperature_max_deci_c) {
    table.fail("temperature_min_c", "must be below temperature_max_c");
  }
}

template <int kCapacity>
void keep_path(TomlTable& table, std::string_view key, const std::string& path,
               FixedText<kCapacity>& kept) {
  if (!kept.assign(path)) table.fail(key, "is too long");
}

void keep_run_paths(TomlTable& table, const std::string& path, EdgeConfig& config) {
  keep_path(table, "run_folder", path, config.state.run_folder);
  keep_path(table, "run_folder", path + "/decisions.ring", config.log.run_ring);
  keep_path(table, "run_folder", path + "/status.json", config.log.run_status);
  keep_path(table, "run_folder", path + "/metrics.prom", config.log.run_metrics);
}

void read_state(TomlTable table, EdgeConfig& config) {
  FixedText<255> folder("state");
  table.text("folder", folder);
  if (folder.empty()) table.fail("folder", "must not be empty");
  table.text("lock_folder", config.state.lock_folder);
  table.boolean("drive_without_state", config.state.drive_without_state);
  const std::string path = table.resolved(folder.view());
  // As the service has it; elsewhere nobody says which folder is in memory.
  FixedText<255> run_folder(kInstalledEdge.run_beside(path));
  table.text("run_folder", run_folder);
  table.finish();
  if (!run_folder.empty()) keep_run_paths(table, table.resolved(run_folder.view()), config);
  keep_path(table, "folder", path, config.state.folder);
  keep_path(table, "folder", path + "/decisions.ring", config.log.ring);
  keep_path(table, "folder", path + "/status.json", config.log.status);
  keep_path(table, "folder", path + "/metrics.prom", config.log.metrics);
}

void read_metrics(TomlTable table, EdgeConfig& config) {
  FixedText<255> prometheus;
  table.text("prometheus", prometheus);
  table.finish();
  if (!prometheus.empty()) {
    keep_path(table, "prometheus", table.resolved(prometheus.view()), config.log.metrics);
  }
}

void read_log(TomlTable table, EdgeConfig& config) {
  FixedText<255> csv;
  table.text("csv", csv);
  table.integer("days", config.log.ring_days, 1, 3'660);
  table.finish();
  if (!csv.empty()) keep_path(table, "csv", table.resolved(csv.view()), config.log.csv);
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
    table.fail("utc_start", "must be a UTC instant such as \"2023-03-26T00:00:00Z\"");
  }
}

}  // namespace

bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error) {
  TomlValue document;
  if (!parse_toml_file(path, document, error)) return false;
  TomlTable root(&document, path, "", error);
  root.boolean("control", config.control.control);
  root.require("price");
  read_battery(section(root, "battery"), config);
  check_battery_against_map(section(root, "battery"), config);
  read_price(section(root, "price"), config);
  read_guard(section(root, "guard"), config);
  read_reserve(root, config.control);
  TomlTable battery = section(root, "battery");
  check_full_charge(battery, config.control);
  read_state(section(root, "state"), config);
  read_log(section(root, "log"), config);
  read_metrics(section(root, "metrics"), config);
  read_simulation(section(root, "simulation"), config.clock);
  read_meter(section(root, "meter"), {config.link, config.map}, config.site);
  read_limits(section(root, "limits"), config.site);
  // Of bess-notify and bess-page: a slip there must not stop the controller.
  for (const char* const others : {"notify", "page"}) static_cast<void>(root.table(others));
  root.finish();
  config.control.price_wait_s = config.price.wait_s;
  set_supervision(config);
  set_site(config);
  if (config.map.watchdog.duration_s > 0) {
    config.control.order_duration_s = config.map.watchdog.duration_s;
    config.control.has_watchdog = true;
  }
  return error.empty();
}

namespace {

FixedText<639> file_in(const char* folder, std::string_view name) {
  char path[640];
  std::snprintf(path, sizeof path, "%s/%.*s", folder, static_cast<int>(name.size()), name.data());
  return {path};
}

}  // namespace

FixedText<639> state_file(const EdgeConfig& config, std::string_view name) {
  return file_in(config.state.folder.c_str(), name);
}

FixedText<639> run_file(const EdgeConfig& config, std::string_view name) {
  if (config.state.run_folder.empty()) return {};
  return file_in(config.state.run_folder.c_str(), name);
}

BothPlaces both_places(const EdgeConfig& config, std::string_view name) {
  return {.state = state_file(config, name), .run = run_file(config, name)};
}

FixedText<159> battery_place(const EdgeConfig& config) {
  const int unit = config.link.unit >= 0 ? config.link.unit : config.map.unit;
  char place[160];
  if (config.link.rtu) {
    std::snprintf(place, sizeof place, "%s unit %d", config.link.device.c_str(), unit);
  } else {
    std::snprintf(place, sizeof place, "%s:%d unit %d", config.link.host.c_str(), config.link.port,
                  unit);
  }
  return FixedText<159>(place);
}

}  // namespace bess
