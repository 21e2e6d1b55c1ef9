// Control cycle benchmark: bess-edge between bess-sim battery and market, measured by its own log.
// Simulated time is scaled, but a device's minimum gap between requests stays in wall time, because
// it dominates the control cycle.
#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "edge/device/battery/modbus_battery.h"
#include "edge/device/registers/map_file.h"
#include "tests/bench/registry.h"
#include "tests/support/simulated_site.h"

namespace bess {
namespace {

constexpr std::int32_t kFastScale = 900;
constexpr int kOrders = 300;

std::string map_path(const std::string& name) {
  return BESS_SOURCE_DIR "/edge/device/maps/" + name;
}

struct CycleSetup {
  std::string map;  ///< file in edge/device/maps
  std::string variant;
  int cycles;
  std::int32_t time_scale;
  std::int32_t gap_ms;  ///< the map's own, wall time
};

/// The map with a gap that lasts `gap_ms` of wall time at this time scale.
std::string map_with_wall_gap(const CycleSetup& setup) {
  std::ifstream file(map_path(setup.map));
  std::ostringstream text;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("minimum_gap_ms")) {
      line = "minimum_gap_ms = " + std::to_string(setup.gap_ms * setup.time_scale);
    }
    text << line << '\n';
  }
  return text.str();
}

/// One column of the log, ascending, only of cycles that wrote registers: an order already in force
/// costs no write.
std::vector<double> sorted_column(const std::vector<CsvRow>& log, const std::string& name) {
  std::vector<double> values;
  std::string writes_before = "0";
  for (const CsvRow& row : log) {
    const bool has_written = row.at("register_writes") != writes_before;
    writes_before = row.at("register_writes");
    if (has_written && row.at("written") == "1" && row.at("mode") == "running") {
      values.push_back(std::stod(row.at(name)));
    }
  }
  std::ranges::sort(values);
  return values;
}

/// Runs bess-edge for `cycles`; the time is the median from arrival of the price row to the
/// read-back of the order.
void edge_cycle(benchmark::State& state, const CycleSetup& setup) {
  SimulatedSite site(setup.time_scale);
  const std::string map = site.folder.write("map.toml", map_with_wall_gap(setup));
  site.start_battery({"--map", map});
  site.start_market({}, SimulatedSite::minute_prices(2 * setup.cycles + 10));
  const std::string config = site.commission(
      {.battery_keys = "map = \"" + map + "\"\nvariant = \"" + setup.variant + "\"\n"});
  for (auto _ : state) {
    ChildProcess edge(
        {edge_program(), "--config", config, "--cycles", std::to_string(setup.cycles)});
    edge.read_all();
    const std::vector<CsvRow> log = read_csv(site.folder.file("edge.csv"));
    const std::vector<double> total_us = sorted_column(log, "total_us");
    const std::vector<double> decision_us = sorted_column(log, "decision_us");
    if (edge.wait() != 0 || total_us.empty()) {
      state.SkipWithError("bess-edge did not run");
      return;
    }
    state.SetIterationTime(total_us[total_us.size() / 2] / 1e6);
    state.counters["worst_ms"] = total_us.back() / 1e3;
    state.counters["decision_us"] = decision_us[decision_us.size() / 2];
    state.counters["decision_us_worst"] = decision_us.back();
    state.counters["cycles"] = static_cast<double>(total_us.size());
  }
}

void add_cycle_benchmark(const std::string& name, const CycleSetup& setup) {
  benchmark_names().push_back(name);
  benchmark::RegisterBenchmark(name.c_str(), edge_cycle, setup)
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime()
      ->Iterations(1);
}

/// Median microseconds of pymodbus for the same order; NaN where it is missing.
double pymodbus_order_us(int port, int orders) {
  ChildProcess peer({"/usr/bin/python3", BESS_SOURCE_DIR "/tests/bench/order_pymodbus.py",
                     std::to_string(port), std::to_string(orders)});
  const std::string answer = peer.read_all();
  if (peer.wait() == 0) return std::stod(answer);
  std::fprintf(stderr,
               "bess-bench: no pymodbus to compare with (tools/setup --test installs it)\n");
  return std::numeric_limits<double>::quiet_NaN();
}

/// An order of eleven registers written and read back, against a battery that answers immediately.
void modbus_order(benchmark::State& state) {
  SimulatedSite site(kFastScale);
  site.start_battery();
  static RegisterMap map;
  std::string error;
  if (!load_register_map(map_path("alphaess.toml"), "block", map, error)) {
    state.SkipWithError(error.c_str());
    return;
  }
  map.minimum_gap_ms = 0;
  BatteryLinkSettings link;
  link.port = site.battery_port;
  ModbusBattery battery(link, map, ScaledClock{});
  PowerOrder order{.power_w = 4'000, .soc_max_e4 = 10'000, .duration_s = 300};
  for (auto _ : state) {
    order.power_w = -order.power_w;
    if (battery.order(order) != Status::kOk) state.SkipWithError("an order failed");
  }
  battery.close();  // the battery serves one client at a time
  report_peer(state, "pymodbus", pymodbus_order_us(site.battery_port, kOrders));
}

}  // namespace

void register_edge_benchmarks() {
  add_benchmark("modbus-order", benchmark::kMicrosecond, 5, modbus_order)->Iterations(kOrders);
  add_cycle_benchmark("edge-cycle", {.map = "simulator.toml",
                                     .variant = "",
                                     .cycles = 1'000,
                                     .time_scale = kFastScale,
                                     .gap_ms = 0});
  // At the device's real pace the battery is read before the tick, within 3 s of simulated time.
  add_cycle_benchmark(
      "edge-cycle-alphaess-block",
      {.map = "alphaess.toml", .variant = "block", .cycles = 5, .time_scale = 2, .gap_ms = 400});
  add_cycle_benchmark("edge-cycle-alphaess-five-writes", {.map = "alphaess.toml",
                                                          .variant = "five_writes",
                                                          .cycles = 5,
                                                          .time_scale = 2,
                                                          .gap_ms = 400});
}

}  // namespace bess
