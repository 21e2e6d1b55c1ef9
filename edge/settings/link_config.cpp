#include "edge/settings/link_config.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

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

}  // namespace bess
