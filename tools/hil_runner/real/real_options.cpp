#include "tools/hil_runner/real/real_options.h"

#include <arpa/inet.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "edge/device/registers/map_file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "tools/simulators/battery_sim/recorded_device.h"
#include "tools/simulators/battery_sim/register_image.h"

namespace bess {

namespace {

/// Events that act on other processes, or leave an order that no process ends.
bool is_for_simulators(ScenarioEvent::EventKind kind) {
  using enum ScenarioEvent::EventKind;
  return kind == kBatteryPause || kind == kBatteryContinue || kind == kEdgeKill ||
         kind == kEdgePause || kind == kEdgeContinue || kind == kEdgeHandOver ||
         kind == kStateLost || is_operator_event(kind);
}

}  // namespace

std::string why_not_real(const Scenario& scenario) {
  if (!scenario.runs_wall) return "it is for virtual time";
  if (!scenario.battery_faults.empty()) {
    const BatteryFault kind = scenario.battery_faults.front().faults.front();
    return fmt::format("only a simulated battery has the fault {}", battery_fault_name(kind));
  }
  const auto event = std::ranges::find_if(scenario.events, is_for_simulators, &ScenarioEvent::kind);
  if (event != scenario.events.end()) {
    return fmt::format("{} is for a simulated battery", event_name(event->kind));
  }
  if (scenario.house.exists()) return "it needs a simulated house and its meter";
  if (scenario.battery.sets_state) return "it sets the battery's SoC, size or limits";
  const bool has_settings = !scenario.edge_battery.empty() || !scenario.edge_guard.empty() ||
                            !scenario.edge_other.empty() || scenario.has_limits();
  return has_settings ? "it sets limits of the edge" : "";
}

std::string why_not_real(const Scenario& scenario, const RealBattery& battery) {
  if (std::string why = why_not_real(scenario); !why.empty()) return why;
  if (scenario.battery.rtu && !battery.is_serial()) return "it is for a serial line";
  const bool is_other_map = scenario.battery.names_map && scenario.battery.map != battery.map;
  if (!is_other_map) return "";
  return fmt::format("it is for the map {}",
                     std::filesystem::path(scenario.battery.map).stem().string());
}

Scenario on_real_battery(Scenario scenario, const RealBattery& battery) {
  scenario.time_scale = battery.time_scale;
  scenario.battery.map = battery.map;
  scenario.battery.variant = battery.variant;
  scenario.battery.rtu = battery.is_serial();
  scenario.battery.physics.power_w_max = battery.power_w;
  scenario.battery.physics.capacity_wh = battery.capacity_wh;
  scenario.edge_guard =
      fmt::format("soc_min = {:.4f}\nsoc_max = {:.4f}", battery.soc_min_frac, battery.soc_max_frac);
  // The flow between two readings is unknown.
  std::erase(scenario.invariants, "energy");
  return scenario;
}

std::string link_keys(const RealBattery& battery) {
  std::string text;
  if (battery.is_serial()) {
    text = fmt::format("transport = \"rtu\"\ndevice = \"{}\"\n", battery.address);
    if (battery.baud) text += fmt::format("baud = {}\n", *battery.baud);
  } else {
    const std::size_t colon = battery.address.rfind(':');
    text = fmt::format("host = \"{}\"\n", battery.address.substr(0, colon));
    if (colon != std::string::npos) {
      text += fmt::format("port = {}\n", battery.address.substr(colon + 1));
    }
  }
  if (battery.unit) text += fmt::format("unit = {}\n", *battery.unit);
  return text;
}

std::vector<DispatchEvent> orders_on_the_bus(const std::vector<std::string>& recordings,
                                             const RegisterMap& map, std::int64_t end_utc_ns) {
  std::vector<BusExchange> exchanges;
  for (const std::string& recording : recordings) {
    read_recording(recording, CutRecording::kAccepted, [&](const BusExchange& exchange) {
      if (exchange.outcome == BusOutcome::kAnswered) exchanges.push_back(exchange);
    });
  }
  if (exchanges.empty()) return {};
  // Never full or empty: only commands matter.
  const BatteryParameters boundless{
      .power_w_max = 1e6, .capacity_wh = 1e9, .soc_min_frac = 0, .soc_max_frac = 1};
  SimulatedBattery battery(boundless, 0.5, exchanges.front().utc_ns);
  std::vector<std::uint16_t> holding(RegisterImage::kRegisterCount), input(holding.size());
  RegisterImage image(map, battery, holding, input);
  // Registers read or written so far: an order may be in percent of a displayed rating.
  std::map<std::uint16_t*, std::uint16_t> known;
  for (const BusExchange& exchange : exchanges) {
    std::uint16_t* place = (exchange.function == 4 ? input : holding).data() + exchange.address;
    for (const std::uint16_t value : exchange.values()) known[place++] = value;
    if (!exchange.is_write()) continue;
    image.refresh(exchange.utc_ns);
    for (const auto& [shown, value] : known) *shown = value;
    image.apply_write(exchange.address, exchange.count);
  }
  image.refresh(end_utc_ns);
  return battery.dispatch_events();
}

std::vector<MinuteRecord> measured_minutes(const std::vector<CycleRecord>& log) {
  std::vector<MinuteRecord> minutes;
  for (const CycleRecord& cycle : log) {
    if (!cycle.has_measurement) continue;
    for (std::int64_t before_s = kSecondsPerStep; before_s > 0; before_s -= 60) {
      minutes.push_back({.minute_utc_s = cycle.utc_s / 60 * 60 - before_s,
                         .energy_wh = cycle.measurement.power_w / 60.0,
                         .soc_frac = cycle.measurement.soc_e4 / 1e4,
                         .commanded_power_w = 0});
    }
  }
  return minutes;
}

std::string beyond_limits(const CycleRecord& cycle, const RealBattery& battery) {
  constexpr double kSocSlackFrac = 0.01;  // a register may have a resolution of 1 %
  const double most_w = 1.2 * battery.power_w + 200;
  const double soc_frac = cycle.measurement.soc_e4 / 1e4;
  if (std::abs(cycle.ordered_power_w) > battery.power_w) {
    return fmt::format("an order of {} W", cycle.ordered_power_w);
  }
  if (!cycle.has_measurement) return "";
  if (std::abs(cycle.measurement.power_w) > most_w) {
    return fmt::format("a power of {} W", cycle.measurement.power_w);
  }
  const bool is_outside = soc_frac < battery.soc_min_frac - kSocSlackFrac ||
                          soc_frac > battery.soc_max_frac + kSocSlackFrac;
  return is_outside ? fmt::format("a SoC of {:.1f} %", 100 * soc_frac) : "";
}

namespace {

constexpr const char* kNoAddress =
    "must be a numeric IPv4 address with or without a port, such as 192.168.1.20:502, or a serial "
    "line such as /dev/ttyUSB0";

std::string complaint_of_address(const std::string& address) {
  if (address.starts_with('/')) {
    return access(address.c_str(), R_OK | W_OK) == 0 ? "" : "cannot be opened as a serial line";
  }
  const std::size_t colon = address.find(':');
  in_addr numeric{};
  if (inet_pton(AF_INET, address.substr(0, colon).c_str(), &numeric) != 1) return kNoAddress;
  if (colon == std::string::npos) return "";
  int port = 0;
  const bool is_number = read_number(std::string_view(address).substr(colon + 1), port);
  return is_number && port >= 1 && port <= 65'535 ? "" : kNoAddress;
}

}  // namespace

void add_real_options(ProgramCommand& command, RealBattery& options) {
  command.flag("--yes-drive-real-battery", options.is_sure,
               "confirmation for --real: charges and discharges that battery");
  command.option("--real-map", options.map, "register map: a name in edge/device/maps, or a path");
  command.option("--real-capacity-wh", options.capacity_wh, "capacity, Wh").positive();
  command.option("--real-power-w", options.power_w, "maximum power of an order, W")
      .range(10.0, 1e8);
  command.option("--real-soc-min", options.soc_min_frac, "minimum SoC, 0 to 1").range(0.0, 1.0);
  command.option("--real-soc-max", options.soc_max_frac, "maximum SoC, 0 to 1").range(0.0, 1.0);
  auto real = command.option(
      "--real", options.address,
      "real battery at this address, HOST[:PORT] or /dev/..., in real time instead of a simulated "
      "one: commissioned, judged by its bus traffic, released at every end. Q or Ctrl-C stops "
      "immediately");
  real.value_name("ADDRESS").check(complaint_of_address);
  for (const char* const other : {"--yes-drive-real-battery", "--real-map", "--real-capacity-wh",
                                  "--real-power-w", "--real-soc-min", "--real-soc-max"}) {
    real.needs(other);
  }
  command.option("--real-variant", options.variant, "map variant (default: the first)")
      .needs("--real");
  command.option("--real-unit", options.unit, "Modbus unit (default: from the map)")
      .range(0, 255)
      .needs("--real");
  command.option("--real-baud", options.baud, "baud rate (default: from the map)")
      .range(1'200, 230'400)
      .needs("--real");
  command
      .option("--real-time-scale", options.time_scale,
              "time scale of a bess-sim battery used instead of a real one")
      .range(1, 900)
      .needs("--real");
}

std::optional<RealBattery> real_battery(const RealBattery& options) {
  if (options.address.empty()) {
    const bool has_others = options.is_sure || !options.map.empty() || options.capacity_wh > 0 ||
                            options.power_w > 0 || options.soc_min_frac >= 0 ||
                            options.soc_max_frac >= 0;
    if (has_others) fail("--real ADDRESS is required by these options");
    return std::nullopt;
  }
  RealBattery battery = options;
  battery.map = map_path(options.map, {});
  if (battery.soc_min_frac >= battery.soc_max_frac) {
    fail("--real-soc-max {} must be above --real-soc-min {}", battery.soc_max_frac,
         battery.soc_min_frac);
  }
  if (battery.baud && !battery.is_serial()) fail("--real-baud requires a serial line");
  RegisterMap map;
  std::string error;
  if (!load_register_map(battery.map, battery.variant, map, error)) throw UserError(error);
  if (!map.models.empty()) {
    fail("--real-map {}: SunSpec maps are not supported: their addresses are not known in advance",
         options.map);
  }
  return battery;
}

}  // namespace bess
