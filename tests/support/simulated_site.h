// bess-sim battery and bess-sim market on free ports, in scaled time, and the configuration with
// which bess-edge drives the one on the prices of the other. Where closed_loop/, soak/ and peers/
// start the real programs.
#pragma once

#include <cmath>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/csv_rows.h"
#include "tests/support/programs_under_test.h"
#include "tests/support/temporary_folder.h"

namespace bess {

class SimulatedSite {
 public:
  static constexpr std::int64_t kStartS = 1'679'788'800;  ///< 2023-03-26T00:00:00Z

  /// Simulated time starts half a second from now.
  explicit SimulatedSite(std::int32_t time_scale) : time_scale_(time_scale) { start_clock(); }
  SimulatedSite(const SimulatedSite&) = delete;
  SimulatedSite& operator=(const SimulatedSite&) = delete;
  /// What a killed controller leaves where all controllers of a machine lock their batteries.
  ~SimulatedSite() {
    std::error_code ignored;
    for (const auto& file : std::filesystem::directory_iterator("/run/lock", ignored)) {
      for (const int port : battery_ports_) {
        const std::string prefix = "bess-127.0.0.1_" + std::to_string(port) + "_";
        const bool is_ours = file.path().filename().string().starts_with(prefix);
        if (is_ours) std::filesystem::remove(file.path(), ignored);
      }
    }
  }

  /// Sets the simulated clock back to its start, for simulators that are started anew.
  void start_clock() { anchor_ns_ = clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond / 2; }
  [[nodiscard]] std::int64_t anchor_ns() const { return anchor_ns_; }

  struct PriceWave {
    double mean_eur_per_mwh = 100;
    double amplitude_eur_per_mwh = 400;
  };
  /// Prices that make the battery charge, rest and discharge, from an hour before the start on.
  static std::string minute_prices(int minutes, const PriceWave& wave) {
    std::ostringstream text;
    text << "minute_utc,indicative_eur_mwh,settled_eur_mwh\n";
    for (int minute = -60; minute < minutes; ++minute) {
      const double price =
          wave.mean_eur_per_mwh + wave.amplitude_eur_per_mwh * std::sin(minute / 7.0);
      text << utc_text(kStartS + 60 * minute).view() << ',' << price << ',' << price << '\n';
    }
    return text.str();
  }
  static std::string minute_prices(int minutes) { return minute_prices(minutes, PriceWave{}); }

  /// `port` 0: any free one. A simulator that comes back is given the port that it had.
  void start_battery(const std::vector<std::string>& options = {}, int port = 0) {
    battery = start_simulator(
        {"battery", "--port", std::to_string(port), "--record", folder.file("battery.csv")},
        options);
    battery_port = port_of(battery->read_line());
    battery_ports_.push_back(battery_port);
  }
  void start_serial_battery(const std::string& device) {
    battery = start_simulator({"battery", "--serial", device, "--baud", "115200"}, {});
    const std::string line = battery->read_line();
    if (line.find("listening on " + device) == std::string::npos) {
      throw std::runtime_error("a simulator did not start: " + line);
    }
  }
  void start_market(const std::vector<std::string>& options = {},
                    const std::string& prices = minute_prices(150), int port = 0) {
    market = start_simulator(
        {"market", "--port", std::to_string(port), "--prices", folder.write("minutes.csv", prices)},
        options);
    market_port = port_of(market->read_line());
  }

  /// Lines of TOML for [battery]: the device, and how long it may take to answer.
  static std::string alphaess_keys(int response_timeout_ms = 100) {
    return "map = \"" BESS_SOURCE_DIR "/edge/maps/alphaess.toml\"\nresponse_timeout_ms = " +
           std::to_string(response_timeout_ms) + "\n";
  }

  struct ConfigOptions {
    std::string battery_keys = alphaess_keys() + "start_timeout_s = 1\n";  ///< all but the port
    std::string price_server = "http://127.0.0.1";                         ///< without its port
    std::string price_keys = "";  ///< lines of TOML for [price], beside the URL
    std::string guard_keys = "";  ///< lines of TOML
    std::string state = "state";  ///< folder; the file is named after it
    std::string state_keys = "";  ///< lines of TOML for [state]
  };

  /// All configurations of a site lock in one place.
  [[nodiscard]] std::string write_config(const ConfigOptions& options) const {
    std::ostringstream text;
    text
        << "control = true\n[battery]\n"
        << options.battery_keys << "port = " << battery_port << "\n[price]\nurl = \""
        << options.price_server << ":" << market_port
        << "/api/explore/v2.1/catalog/datasets/ods161/records?order_by=datetime%20desc&limit=20\"\n"
        << options.price_keys << "[guard]\n"
        << options.guard_keys << "[state]\nfolder = \"" << options.state << "\"\nlock_folder = \""
        << folder.file("") << "\"\n"
        << options.state_keys
        << "[log]\ncsv = \"edge.csv\"\n[simulation]\ntime_scale = " << time_scale_
        << "\nutc_start = \"" << utc_text(kStartS).view()
        << "\"\nanchor_monotonic_ns = " << anchor_ns_ << "\n";
    return folder.write(options.state + ".toml", text.str());
  }
  [[nodiscard]] std::string write_config() const { return write_config(ConfigOptions{}); }

  /// The configuration after the sign check that control needs.
  [[nodiscard]] std::string commission(const ConfigOptions& options) const {
    const std::string config = write_config(options);
    ChildProcess check({edge_program(), "commission", "--config", config, "--yes"});
    const std::string text = check.read_all();
    if (check.wait() != 0 || text.find("the sign is right") == std::string::npos) {
      throw std::runtime_error("the sign check failed: " + text);
    }
    return config;
  }
  [[nodiscard]] std::string commission() const { return commission(ConfigOptions{}); }

  /// Ends a program as an operator would; its exit code.
  static int stop(ChildProcess& child) {
    child.signal(SIGTERM);
    return child.wait();
  }

  TemporaryFolder folder;
  int battery_port = 1;  ///< nobody listens there before a simulator does
  int market_port = 1;
  std::unique_ptr<ChildProcess> battery;
  std::unique_ptr<ChildProcess> market;

 private:
  std::unique_ptr<ChildProcess> start_simulator(std::vector<std::string> arguments,
                                                const std::vector<std::string>& options) const {
    arguments.insert(arguments.begin(), sim_program());
    for (const std::string& option :
         {std::string("--utc-start"), std::string(utc_text(kStartS).view()),
          std::string("--time-scale"), std::to_string(time_scale_),
          std::string("--anchor-monotonic-ns"), std::to_string(anchor_ns_)}) {
      arguments.push_back(option);
    }
    arguments.insert(arguments.end(), options.begin(), options.end());
    return std::make_unique<ChildProcess>(arguments);
  }

  /// Of "... listening on HOST:PORT, ...".
  static int port_of(const std::string& line) {
    const std::size_t colon = line.find(':', line.find("127.0.0.1"));
    const int port = colon == std::string::npos ? 0 : std::atoi(line.c_str() + colon + 1);
    if (port == 0) throw std::runtime_error("a simulator did not start: " + line);
    return port;
  }

  std::int32_t time_scale_;
  std::int64_t anchor_ns_ = 0;
  std::vector<int> battery_ports_;
};

}  // namespace bess
