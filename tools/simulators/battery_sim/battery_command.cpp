// bess-sim battery: options and composition.
#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>

#include "edge/device/registers/map_file.h"
#include "shared/battery_keys.h"
#include "shared/host/file.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "tools/simulators/battery_sim/battery_faults.h"
#include "tools/simulators/battery_sim/battery_record.h"
#include "tools/simulators/battery_sim/battery_server.h"
#include "tools/simulators/sim/clock_options.h"
#include "tools/simulators/sim/commands.h"
#include "tools/simulators/sim/stop_signal.h"

namespace bess {

void read_battery_file(const std::string& path, BatteryParameters& battery) {
  std::string error;
  TomlValue document;
  if (!parse_toml_file(path, document, error)) throw UserError(error);
  TomlTable table(document.find("battery"), path, "[battery]", error);
  if (document.find("battery") == nullptr) fail("{}: has no [battery]", path);
  for (const BatteryKey& key : kBatteryKeys) {
    table.number(key.name, key.of(battery), key.low, key.high);
  }
  for (const char* of_workstation : {"wear_eur_per_mwh", "cycles_per_day_max", "initial_soc",
                                     "fade_percent_per_1000_cycles", "minimum_run_min"}) {
    double ignored = 0;  // keys that only the workstation uses
    table.number(of_workstation, ignored, 0, 1'000);
  }
  table.finish();
  if (!error.empty()) throw UserError(error);
  if (const char* wrong = battery_contradiction(battery)) fail("{}: [battery] {}", path, wrong);
}

namespace {

UtcText time_text(std::int64_t utc_ns) { return utc_text(utc_ns / kNanosecondsPerSecond); }

std::string place_of(const BatteryServerSettings& settings, const BatteryServer& server) {
  return settings.serial_device.empty() ? fmt::format("{}:{}", settings.host, server.port())
                                        : settings.serial_device;
}

struct BatteryOptions {
  BatteryServerSettings server;
  ClockOptions clock;
  std::string map_path = BESS_MAP_DIR "/alphaess.toml";
  std::vector<std::string> fault_names;
  std::string map_variant;
  std::string record_path;
  std::string events_path;
  double soc_frac = 0.5;
  BatteryParameters battery{.power_w_max = 4'000, .capacity_wh = 8'000};
  double round_trip_efficiency = 0.9;
  std::string battery_path;  ///< empty: none
  std::string house;         ///< empty: none, and no meter
  std::uint64_t house_seed = 1;
  std::string meter_map_path;
  std::string meter_variant;
  /// Any free port, several clients; a fault applies for its whole time span.
  BatteryServerSettings meter{.port = 0, .clients_max = 4, .faults = {.every = 1}};
  std::vector<std::string> meter_fault_names;
  std::string replay_path;  ///< empty: no replay
  bool accept_cut = false;
};

/// Serves a recorded device instead of a simulated one, until stopped.
void run_replay(const BatteryOptions& options) {
  const StopSignal stop;
  const ScaledClock clock = options.clock.clock();
  RecordedDevice device(options.replay_path,
                        options.accept_cut ? CutRecording::kAccepted : CutRecording::kRefused);
  static RegisterMap no_points;  // the recording answers
  no_points.unit = device.head().unit;
  SimulatedBattery unused({}, 0.5, clock.now_utc_ns());
  BatteryServer battery(options.server, no_points, unused, clock);
  battery.replay(device);
  const std::string place = place_of(options.server, battery);
  std::printf(
      "bess-sim battery: listening on %s, unit %d, replaying %s, %s, %lld exchanges from %s to "
      "%s%s\n",
      place.c_str(), device.head().unit, options.replay_path.c_str(), device.head().map.c_str(),
      static_cast<long long>(device.exchanges()), time_text(device.first_utc_ns()).c_str(),
      time_text(device.last_utc_ns()).c_str(),
      clock.is_real_time() ? ", which begins at the first request" : "");
  std::fflush(stdout);
  battery.run(stop.fd());
  std::printf("bess-sim battery: stopped\n");
}

std::string known_fault(const std::string& name) {
  return find_fault(name) != nullptr ? "" : "unknown fault " + name;
}

/// Options first; the battery file overrides them.
BatteryParameters battery_of(const BatteryOptions& options) {
  BatteryParameters battery = options.battery;
  battery.charge_efficiency = battery.discharge_efficiency =
      std::sqrt(options.round_trip_efficiency);
  if (!options.battery_path.empty()) read_battery_file(options.battery_path, battery);
  return battery;
}

/// Meter at the house connection, served by its own thread.
class MeterThread {
 public:
  MeterThread(const BatteryOptions& options, SimulatedBattery& battery, const ScaledClock& clock,
              MeteredHouse& house) {
    std::string error;
    if (!load_register_map(options.meter_map_path, options.meter_variant, map_, error)) {
      throw UserError(error);
    }
    if (!map_.is_meter) fail("--meter-map {}: is not a meter map", options.meter_map_path);
    server_.emplace(options.meter, map_, battery, clock, &house);
    if (pipe2(stop_, O_CLOEXEC) != 0) fail("cannot create a pipe for the meter");
    thread_ = std::thread([this] { server_->run(stop_[0]); });
  }
  MeterThread(const MeterThread&) = delete;
  MeterThread& operator=(const MeterThread&) = delete;
  ~MeterThread() {
    close(stop_[1]);
    thread_.join();
    close(stop_[0]);
  }
  [[nodiscard]] int port() const { return server_->port(); }
  [[nodiscard]] int unit() const { return map_.unit; }

 private:
  RegisterMap map_;
  std::optional<BatteryServer> server_;
  int stop_[2] = {-1, -1};
  std::thread thread_;
};

/// Refuses faults that this kind of bus cannot have.
void take_faults(const std::vector<std::string>& names, BatteryServerSettings& server) {
  const bool rtu = !server.serial_device.empty();
  for (const std::string& name : names) {
    const BatteryFaultInfo& info = *find_fault(name);
    if (!(rtu ? info.rtu : info.tcp)) {
      fail("--fault {}: only {} a serial line", name, rtu ? "without" : "on");
    }
    server.faults.faults.push_back(info.fault);
  }
}

void require_span(const char* name, const FaultSchedule& faults) {
  if (faults.on_s > 0 && faults.off_s == 0) {
    fail("--{}-on-s {:g}: requires --{}-off-s", name, faults.on_s, name);
  }
  if (faults.from_s < faults.to_s) return;
  fail("--{}-from-s {:g}: must be before --{}-to-s {:g}; no fault would occur", name, faults.from_s,
       name, faults.to_s);
}

/// Checks the options before anything listens.
void require_consistent(const BatteryOptions& options) {
  const BatteryParameters& battery = options.battery;
  if (!(battery.soc_min_frac < battery.soc_max_frac)) {
    fail("--soc-min {:g}: must be below --soc-max {:g}", battery.soc_min_frac,
         battery.soc_max_frac);
  }
  require_span("fault", options.server.faults);
  require_span("meter-fault", options.meter.faults);
  if (!options.meter_map_path.empty() && options.meter.port != 0 &&
      options.meter.port == options.server.port && options.server.serial_device.empty()) {
    fail("--meter-port {}: is already the battery's --port; use another port", options.meter.port);
  }
  require_distinct({{"--record", options.record_path}}, {{"--map", options.map_path},
                                                         {"--meter-map", options.meter_map_path},
                                                         {"--house", options.house}});
}

void run_battery(BatteryOptions& options) {
  if (!options.replay_path.empty()) return run_replay(options);
  const StopSignal stop;
  require_consistent(options);
  take_faults(options.fault_names, options.server);
  take_faults(options.meter_fault_names, options.meter);
  const ScaledClock clock = options.clock.clock();
  // Fails before serving, not at the end of the run.
  if (!options.record_path.empty()) require_writable(options.record_path);
  if (!options.events_path.empty()) require_writable(options.events_path);
  static RegisterMap map;
  std::string error;
  if (!load_register_map(options.map_path, options.map_variant, map, error)) {
    throw UserError(error);
  }
  const BatteryParameters battery = battery_of(options);
  if (battery.power_w_max > map.charge_w_max || battery.power_w_max > map.discharge_w_max) {
    fail("--power-w {}: exceeds the range of the map {}", battery.power_w_max, map.name.view());
  }
  SimulatedBattery simulated(battery, options.soc_frac, clock.now_utc_ns());
  std::optional<MeteredHouse> house;
  if (!options.house.empty()) {
    house.emplace(HouseLoad::from_option(options.house, options.house_seed));
  }
  BatteryServer server(options.server, map, simulated, clock, house ? &*house : nullptr);
  std::optional<MeterThread> meter;
  if (!options.meter_map_path.empty()) meter.emplace(options, simulated, clock, *house);
  const std::string place = place_of(options.server, server);
  std::printf("bess-sim battery: listening on %s, unit %d, %s at time scale %d\n", place.c_str(),
              map.unit, time_text(clock.now_utc_ns()).c_str(), clock.scale);
  if (meter) {
    std::printf("bess-sim battery: meter listening on %s:%d, unit %d\n", options.meter.host.c_str(),
                meter->port(), meter->unit());
  }
  std::fflush(stdout);
  server.run(stop.fd());
  meter.reset();
  if (!options.record_path.empty()) {
    write_battery_record(options.record_path, simulated.record(), house ? &house->load : nullptr);
  }
  if (!options.events_path.empty()) write_dispatch_events(options.events_path, simulated);
  std::printf("bess-sim battery: stopped at SoC %.2f %%\n", 100 * simulated.soc_frac());
}

std::string footer() {
  std::string text =
      "Examples:\n"
      "  bess-sim battery --port 1502 --soc 0.5\n"
      "  bess-sim battery --serial /dev/ttyUSB0 --baud 9600\n"
      "  bess-sim battery --port 1502 --utc-start 2023-03-26T00:00:00Z --time-scale 900 "
      "--anchor-monotonic-ns $(bess-sim clock) --record battery.csv\n"
      "  bess-sim battery --port 1502 --fault drop --fault-every 7\n"
      "  bess-sim battery --port 1502 --fault late wrong-unit drip --fault-probability 0.1 "
      "--fault-seed 3 --fault-from-s 600 --fault-to-s 3600\n"
      "  bess-sim battery --port 1502 --house daily --meter-map edge/device/meters/sunspec.toml "
      "--meter-port 1503\n"
      "  bess-sim battery --port 1502 --replay inverter.jsonl\n"
      "Serial line on one machine: socat pty,raw,echo=0,link=a pty,raw,echo=0,link=b, then "
      "--serial a here and device = \"b\" in the controller's configuration.\n"
      "Faults:\n";
  for (const BatteryFaultInfo& fault : battery_faults()) {
    text += fmt::format("  {:<20} {}\n", fault.name, fault.text);
  }
  return text;
}

void add_bus_options(ProgramCommand& command, BatteryServerSettings& server) {
  command.option("--host", server.host, "numeric IPv4 address to listen on").ipv4().with_default();
  command.option("--port", server.port, "TCP port; 0: any free port")
      .range(0, 65'535)
      .with_default();
  command.option("--clients-max", server.clients_max, "maximum number of clients; more are refused")
      .range(1, 32)
      .with_default();
  command.option("--serial", server.serial_device, "serial device for Modbus RTU, instead of TCP")
      .excludes("--host")
      .excludes("--port")
      .excludes("--clients-max");
  command.option("--baud", server.baud, "baud rate of the serial line")
      .with_default()
      .needs("--serial");
  command
      .choice<char>("--parity", server.parity, {{"none", 'N'}, {"even", 'E'}, {"odd", 'O'}},
                    "parity of the serial line: none, even or odd")
      .needs("--serial");
  command.option("--stop-bits", server.stop_bits, "stop bits: 1 or 2")
      .range(1, 2)
      .needs("--serial");
  command.option("--response-delay-ms", server.response_delay_ms, "delay before each response, ms")
      .range(0, 60'000);
}

/// Time span of a fault, and its on-off cycle.
void add_fault_span(ProgramCommand& command, const std::string& fault, FaultSchedule& faults) {
  command
      .option(fault + "-from-s", faults.from_s, "Start of the fault, simulated s after the start")
      .non_negative()
      .needs(fault);
  command.option(fault + "-to-s", faults.to_s, "End of the fault, simulated s after the start")
      .non_negative()
      .needs(fault);
  command.option(fault + "-on-s", faults.on_s, "Intermittent fault: on-time, s")
      .positive()
      .needs(fault);
  command.option(fault + "-off-s", faults.off_s, "Intermittent fault: off-time, s")
      .positive()
      .needs(fault + "-on-s");
}

void add_fault_options(ProgramCommand& command, BatteryOptions& options) {
  FaultSchedule& faults = options.server.faults;
  command
      .option("--fault", options.fault_names,
              "faults to inject, see below; with several, one at random each time")
      .check(known_fault)
      .value_name("NAME");
  const auto whole = [&command](const char* name, std::int32_t& value, int most, const char* help) {
    command.option(name, value, help).range(1, most).with_default().needs("--fault");
  };
  whole("--fault-every", faults.every, 1'000'000, "inject at every Nth opportunity");
  command
      .option("--fault-probability", faults.probability, "probability at each opportunity, 0 to 1")
      .range(0.0, 1.0)
      .needs("--fault")
      .excludes("--fault-every");
  command.option("--fault-seed", faults.seed, "random seed of the faults")
      .with_default()
      .needs("--fault");
  add_fault_span(command, "--fault", faults);
  whole("--fault-period-s", faults.period_s, 86'400,
        "interval of faults that end or replace orders, s");
  whole("--late-ms", faults.late_ms, 60'000, "delay of the faults late and byte-gap, ms");
  whole("--drip-ms", faults.drip_ms, 60'000, "interval between bytes of the fault drip, ms");
  whole("--exception-code", faults.exception_code, 255,
        "Modbus exception code: 1, 2, 3, 4, 6 or vendor code");
}

void add_plant_options(ProgramCommand& command, BatteryOptions& options) {
  const auto number = [&command](const char* name, double& value, double low, double high,
                                 const char* help) {
    command.option(name, value, help).range(low, high).with_default();
  };
  command.option("--map", options.map_path, "register map of the simulated device (TOML)");
  command.option("--variant", options.map_variant, "map variant (default: the first)");
  number("--soc", options.soc_frac, 0, 1, "state of charge at start, 0 to 1");
  add_rating_options(command, options.battery);
  number("--soc-min", options.battery.soc_min_frac, 0, 1, "battery's minimum SoC, 0 to 1");
  number("--soc-max", options.battery.soc_max_frac, 0, 1, "battery's maximum SoC, 0 to 1");
  number("--efficiency", options.round_trip_efficiency, 0.01, 1, "round-trip efficiency, 0 to 1");
  command.option("--battery", options.battery_path,
                 "file with battery parameters in [battery] (bess-train battery fit)");
  number("--time-constant-s", options.battery.response.time_constant_s, 0, 600,
         "time constant of the first-order power response, s; 0: immediate");
  command.option("--record", options.record_path,
                 "CSV file of energy and SoC per simulated minute, written at exit");
  command.option("--events", options.events_path,
                 "CSV file of every order and its end, written at exit");
}

void add_replay_options(ProgramCommand& command, BatteryOptions& options) {
  command.option(
      "--replay", options.replay_path,
      "replay a recording (bess-edge record) by address and time; other options of battery, "
      "house and faults are ignored");
  command.flag("--accept-cut", options.accept_cut,
               "accept a recording that ends without its last line");
}

void add_house_options(ProgramCommand& command, BatteryOptions& options) {
  command.option(
      "--house", options.house,
      "house load behind the same meter: daily, power in W, or CSV file (minute_utc,house_w)");
  command.option("--house-seed", options.house_seed, "random seed of --house daily")
      .with_default()
      .needs("--house");
  command
      .option(
          "--meter-map", options.meter_map_path,
          "register map of a meter to simulate as well (edge/device/meters); not needed when the "
          "battery map has a grid point")
      .needs("--house");
  command.option("--meter-variant", options.meter_variant, "map variant (default: the first)")
      .needs("--meter-map");
  command.option("--meter-port", options.meter.port, "TCP port of the meter; 0: any free port")
      .range(0, 65'535)
      .with_default()
      .needs("--meter-map");
  command
      .option("--meter-fault", options.meter_fault_names,
              "meter faults, at every opportunity: silence, frozen, wrong-sign, grid-scaled, ...")
      .check(known_fault)
      .value_name("NAME")
      .needs("--meter-map");
  add_fault_span(command, "--meter-fault", options.meter.faults);
}

}  // namespace

void add_battery_command(ProgramCommand& app) {
  auto options = std::make_shared<BatteryOptions>();
  ProgramCommand command =
      app.subcommand("battery", "simulate a Modbus battery (TCP or RTU) of any register map");
  command.footer(footer());
  add_bus_options(command, options->server);
  options->clock.add_to(command);
  add_plant_options(command, *options);
  add_house_options(command, *options);
  add_fault_options(command, *options);
  add_replay_options(command, *options);
  command.runs([options] { run_battery(*options); });
}

}  // namespace bess
