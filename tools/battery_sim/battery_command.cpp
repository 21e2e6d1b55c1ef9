// bess-sim battery: options and composition.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <map>

#include "edge/registers/map_file.h"
#include "shared/utc_text.h"
#include "tools/battery_sim/battery_record.h"
#include "tools/battery_sim/battery_server.h"
#include "tools/sim/clock_options.h"
#include "tools/sim/commands.h"
#include "tools/sim/sim_error.h"
#include "tools/sim/stop_signal.h"

namespace bess {
namespace {

struct BatteryOptions {
  BatteryServerSettings server;
  ClockOptions clock;
  std::string map_path = BESS_MAP_DIR "/alphaess.toml";
  std::string record_path;
  double soc_frac = 0.5;
  BatteryParameters battery{.power_w_max = 4'000, .capacity_wh = 8'000};
  double round_trip_efficiency = 0.9;
};

/// Fails before serving rather than after a day when the record cannot be written.
void check_record_folder(const std::string& path) {
  if (path.empty()) return;
  const auto slash = path.find_last_of('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  if (access(folder.c_str(), W_OK) != 0) sim_fail("{}: cannot write in this folder", path);
}

void run_battery(BatteryOptions& options) {
  const StopSignal stop;
  const ScaledClock clock = options.clock.clock();
  check_record_folder(options.record_path);
  static RegisterMap map;
  std::string error;
  if (!load_register_map(options.map_path, "", map, error)) throw SimError(error);
  BatteryParameters& battery = options.battery;
  battery.charge_efficiency = battery.discharge_efficiency =
      std::sqrt(options.round_trip_efficiency);
  if (battery.power_w_max > map.charge_w_max || battery.power_w_max > map.discharge_w_max) {
    sim_fail("--power-w {}: more than the map {} can express", battery.power_w_max,
             map.name.view());
  }
  SimulatedBattery simulated(battery, options.soc_frac, clock.now_utc_ns());
  BatteryServer server(options.server, map, simulated, clock);
  std::printf("bess-sim battery: listening on %s:%d, unit %d, %s at time scale %d\n",
              options.server.host.c_str(), server.port(), map.unit,
              utc_text(clock.now_utc_ns() / kNanosecondsPerSecond).c_str(), clock.scale);
  std::fflush(stdout);
  server.run(stop.fd());
  if (!options.record_path.empty()) write_battery_record(options.record_path, simulated);
  std::printf("bess-sim battery: stopped at SoC %.2f %%\n", 100 * simulated.soc_frac());
}

}  // namespace

void add_battery_command(CLI::App& app) {
  auto options = std::make_shared<BatteryOptions>();
  CLI::App* command = app.add_subcommand("battery", "A Modbus TCP battery (AlphaESS registers)");
  command->footer(
      "Examples:\n"
      "  bess-sim battery --port 1502 --soc 0.5\n"
      "  bess-sim battery --port 1502 --utc-start 2023-03-26T00:00:00Z --time-scale 900 "
      "--anchor-monotonic-ns $(bess-sim clock) --record battery.csv\n"
      "  bess-sim battery --port 1502 --fault drop --fault-every 7");
  BatteryServerSettings& server = options->server;
  command->add_option("--host", server.host, "Numeric address to listen on")->capture_default_str();
  command->add_option("--port", server.port, "TCP port, 0 = any free one")
      ->check(CLI::Range(0, 65'535))
      ->capture_default_str();
  options->clock.add_to(*command);
  command->add_option("--map", options->map_path, "Register map (TOML)");
  command->add_option("--soc", options->soc_frac, "State of charge at start, 0..1")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--power-w", options->battery.power_w_max, "Rated power")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--capacity-wh", options->battery.capacity_wh, "Capacity")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--soc-min", options->battery.soc_min_frac, "The battery's own floor")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--soc-max", options->battery.soc_max_frac, "The battery's own ceiling")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--efficiency", options->round_trip_efficiency, "Round trip")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--record", options->record_path,
                      "CSV of energy and SoC per simulated minute, written at exit");
  command->add_option("--response-delay-ms", server.response_delay_ms, "Before every answer")
      ->check(CLI::Range(0, 60'000));
  const std::map<std::string, BatteryFault> faults = {
      {"silence", BatteryFault::kSilence},
      {"late", BatteryFault::kLate},
      {"exception", BatteryFault::kException},
      {"drop", BatteryFault::kDrop},
      {"ack-without-effect", BatteryFault::kAckWithoutEffect}};
  command->add_option("--fault", server.fault, "Misbehave now and then")
      ->transform(CLI::Transformer(faults, CLI::ignore_case))
      ->type_name("silence|late|exception|drop|ack-without-effect");
  command->add_option("--fault-every", server.fault_every, "At every Nth request (or write)")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  command->add_option("--late-ms", server.late_ms, "Delay of --fault late")
      ->check(CLI::Range(1, 60'000))
      ->capture_default_str();
  command->callback([options] { run_battery(*options); });
}

}  // namespace bess
