#include "tools/hil_runner/real/real_options.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <charconv>

#include "edge/registers/map_file.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr const char* kNoAddress =
    "must be a numeric IPv4 address with or without a port, such as 192.168.1.20:502, or a serial "
    "line such as /dev/ttyUSB0";

std::string complaint_of_address(const std::string& address) {
  if (address.starts_with('/')) {
    return access(address.c_str(), R_OK | W_OK) == 0 ? "" : "no serial line that may be opened";
  }
  const std::size_t colon = address.find(':');
  in_addr numeric{};
  if (inet_pton(AF_INET, address.substr(0, colon).c_str(), &numeric) != 1) return kNoAddress;
  if (colon == std::string::npos) return "";
  int port = 0;
  const char* const end = address.data() + address.size();
  const auto [rest, error] = std::from_chars(address.data() + colon + 1, end, port);
  return error == std::errc{} && rest == end && port >= 1 && port <= 65'535 ? "" : kNoAddress;
}

}  // namespace

void add_real_options(ProgramCommand& command, RealOptions& options) {
  command.flag("--yes-drive-real-battery", options.is_sure,
               "Said besides --real: the battery there is charged and discharged");
  command.option("--real-map", options.map, "Its register map: a name of edge/maps, or a path");
  command.option("--real-capacity-wh", options.capacity_wh, "What it holds").positive();
  command.option("--real-power-w", options.power_w, "No order is larger").range(10.0, 1e8);
  command.option("--real-soc-min", options.soc_min_frac, "No discharge below").range(0.0, 1.0);
  command.option("--real-soc-max", options.soc_max_frac, "No charge above").range(0.0, 1.0);
  auto real = command.option(
      "--real", options.address,
      "Drive the battery at this address, HOST[:PORT] or /dev/..., in real time, instead of "
      "a simulated one: commissioned, judged by what went over its bus, released on every way out. "
      "Q or Ctrl-C ends it at once");
  real.value_name("ADDRESS").check(complaint_of_address);
  for (const char* const other : {"--yes-drive-real-battery", "--real-map", "--real-capacity-wh",
                                  "--real-power-w", "--real-soc-min", "--real-soc-max"}) {
    real.needs(other);
  }
  command.option("--real-variant", options.variant, "Of the map; default: its first")
      .needs("--real");
  command.option("--real-unit", options.unit, "Default: the map's").range(0, 255).needs("--real");
  command.option("--real-baud", options.baud, "Default: the map's")
      .range(1'200, 230'400)
      .needs("--real");
  command
      .option("--real-time-scale", options.time_scale,
              "For a bess-sim battery that runs at this scale and stands for a real one")
      .range(1, 900)
      .needs("--real");
}

std::optional<RealBattery> real_battery(const RealOptions& options) {
  if (options.address.empty()) {
    const bool has_others = options.is_sure || !options.map.empty() || options.capacity_wh ||
                            options.power_w || options.soc_min_frac || options.soc_max_frac;
    if (has_others)
      fail("--real is missing: the address of the battery that these options speak of");
    return std::nullopt;
  }
  RealBattery battery{.address = options.address,
                      .map = map_path(options.map, {}),
                      .variant = options.variant,
                      .unit = options.unit,
                      .baud = options.baud,
                      .capacity_wh = *options.capacity_wh,
                      .power_w = *options.power_w,
                      .soc_min_frac = *options.soc_min_frac,
                      .soc_max_frac = *options.soc_max_frac,
                      .time_scale = options.time_scale};
  if (battery.soc_min_frac >= battery.soc_max_frac) {
    fail("--real-soc-max {} must be above --real-soc-min {}", battery.soc_max_frac,
         battery.soc_min_frac);
  }
  if (battery.baud && !battery.is_serial()) fail("--real-baud is for a serial line");
  RegisterMap map;
  std::string error;
  if (!load_register_map(battery.map, battery.variant, map, error)) throw UserError(error);
  if (!map.models.empty()) {
    fail(
        "--real-map {}: where a SunSpec device has its models is not known beforehand, so that "
        "what it was told could not be judged",
        options.map);
  }
  return battery;
}

}  // namespace bess
