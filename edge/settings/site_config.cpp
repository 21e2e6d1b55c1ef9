#include "edge/settings/site_config.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "edge/registers/map_file.h"

namespace bess {

namespace {

bool is_numeric_ipv4(const char* host) {
  in_addr address{};
  return inet_pton(AF_INET, host, &address) == 1;
}

/// What the operator does not say about the link is as the device's maker ships it.
void complete_link(TomlTable& table, BatteryLinkSettings& link, RegisterMap& map) {
  if (!table.has("port")) link.port = map.port;
  if (!table.has("baud")) link.baud = map.baud;
  if (!table.has("parity")) link.parity = map.parity;
  if (!table.has("stop_bits")) link.stop_bits = map.stop_bits;
  TomlTable units(table.table("units"), table.file(), table.where() + " units", table.error());
  for (UnitGroup& group : map.unit_groups) units.integer(group.name.view(), group.unit, 0, 255);
  units.finish();
}

}  // namespace

void read_link(TomlTable& table, BatteryLinkSettings& link) {
  int transport = 0;
  int parity = 0;
  table.choice("transport", transport, {"tcp", "rtu"});
  table.text("host", link.host);
  table.integer("port", link.port, 1, 65'535);
  table.text("device", link.device);
  table.integer("baud", link.baud, 1'200, 230'400);
  table.choice("parity", parity, {"none", "even", "odd"});
  table.integer("stop_bits", link.stop_bits, 1, 2);
  table.integer("unit", link.unit, 0, 255);
  table.integer("response_timeout_ms", link.response_timeout_ms, 10, 30'000);
  static_cast<void>(table.table("units"));
  link.rtu = transport == 1;
  link.parity = static_cast<Parity>(parity);
}

void check_link(TomlTable& table, const BatteryLinkSettings& link) {
  if (!is_serial_speed(link.baud)) {
    table.fail("baud", "must be a speed of serial lines such as 9600, 19200 or 115200");
  }
  if (!link.rtu && !is_numeric_ipv4(link.host.c_str())) {
    table.fail("host",
               "must be a numeric IPv4 address such as \"192.168.1.20\": a name would "
               "depend on the resolver at every reconnect");
  }
}

bool load_linked_map(TomlTable& table, std::string_view map_file, std::string_view variant,
                     BatteryLinkSettings& link, RegisterMap& map, FixedText<511>& path) {
  if (!table.ok()) return false;
  const std::string map_path = table.resolved(map_file);
  if (!path.assign(map_path)) table.fail("map", "is too long");
  if (access(map_path.c_str(), R_OK) != 0) {
    table.fail("map", "= " + map_path + " cannot be read: " + std::strerror(errno) +
                          "; the installed maps lie in share/bess/maps, of meters in "
                          "share/bess/meters");
    return false;
  }
  if (!load_register_map(map_path, variant, map, table.error())) return false;
  complete_link(table, link, map);
  return table.ok();
}

namespace {

constexpr std::int64_t kConnectionWMax = 100'000'000;

void read_connection(TomlTable& table, ConnectionSettings& connection) {
  table.integer("import_w_max", connection.import_w_max, 0, kConnectionWMax);
  table.integer("export_w_max", connection.export_w_max, 0, kConnectionWMax);
  table.integer("peak_w_max", connection.peak_w_max, 1, kConnectionWMax);
  table.integer("margin_w", connection.margin_w, 0, kConnectionWMax);
  table.boolean("peak_shave", connection.peak_shave);
}

void check_connection(TomlTable& table, const ConnectionSettings& connection) {
  for (const char* const key : {"import_w_max", "peak_w_max"}) {
    const std::int32_t limit_w = key[0] == 'i' ? connection.import_w_max : connection.peak_w_max;
    if (limit_w <= connection.margin_w) {
      table.fail(key, "must be above margin_w (" + std::to_string(connection.margin_w) +
                          "): the battery would never charge");
    }
  }
  if (table.has("peak_w_max")) return;
  if (table.has("peak_shave")) table.fail("peak_shave", "means nothing without peak_w_max");
}

bool is_same_line(const BatteryLinkSettings& a, const BatteryLinkSettings& b) {
  if (!a.rtu || !b.rtu) return false;
  std::error_code ignored;
  return a.device == b.device.view() ||
         std::filesystem::equivalent(a.device.c_str(), b.device.c_str(), ignored);
}

void load_meter_map(TomlTable& table, const MeteredBattery& battery, std::string_view map_file,
                    std::string_view variant, SiteConfig& site) {
  check_link(table, site.link);
  FixedText<511> path;
  if (!load_linked_map(table, map_file, variant, site.link, site.map, path)) return;
  if (!site.map.is_meter) {
    table.fail("map", "is a battery's map; meters lie in meters/, their maps say kind = \"meter\"");
  }
  if (is_same_line(site.link, battery.link)) {
    table.fail("device",
               "is the battery's serial line, which it has for itself: use another line, or "
               "source = \"battery\" where the battery has a grid point");
  }
}

void use_grid_point(TomlTable& table, const MeteredBattery& battery) {
  if (!table.ok() || measure_grid_power(battery.map)) return;
  table.fail("source", "= \"battery\": the battery's map " + std::string(battery.map.name.view()) +
                           " has no grid point; use a meter's map");
}

}  // namespace

void read_meter(TomlTable table, MeteredBattery battery, SiteConfig& site) {
  if (table.value() == nullptr) return;
  SiteSettings& settings = site.settings;
  int source = 0;
  int on_loss = 0;
  FixedText<255> map_file;
  RegisterName variant;
  table.choice("source", source, {"map", "battery"});
  settings.meter = source == 0 ? MeterSource::kMap : MeterSource::kBattery;
  if (settings.meter == MeterSource::kMap) {
    table.require("map");
    table.text("map", map_file);
    table.text("variant", variant);
    read_link(table, site.link);
  }
  read_connection(table, settings.connection);
  table.choice("on_loss", on_loss, {"idle", "ignore"});
  table.boolean("judged", settings.witness.judges);
  table.integer("pv_w_max", settings.pv_w_max, 0, kConnectionWMax);
  table.finish();
  settings.idle_without_meter = on_loss == 0;
  check_connection(table, settings.connection);
  if (settings.meter == MeterSource::kMap) {
    load_meter_map(table, battery, map_file.view(), variant.view(), site);
  } else {
    use_grid_point(table, battery);
  }
}

void read_limits(TomlTable table, SiteConfig& site) {
  if (table.value() == nullptr) return;
  FixedText<255> file;
  int on_timeout = 0;
  table.require("file");
  table.text("file", file);
  table.choice("on_timeout", on_timeout, {"release_limits", "idle"});
  table.finish();
  if (!table.ok()) return;
  if (!site.limit_file.assign(table.resolved(file.view()))) {
    table.fail("file", "is too long a path");
  }
  site.settings.has_outside_limits = true;
  site.settings.idle_after_timeout = on_timeout == 1;
}

}  // namespace bess
