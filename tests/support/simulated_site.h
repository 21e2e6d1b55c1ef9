// Simulated site (tools/simulators/site) in its own folder, its market prices, and the
// configuration with which bess-edge drives it. closed_loop/, soak/ and peers/ start the real
// programs here.
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tests/support/csv_rows.h"
#include "tests/support/loopback_socket.h"
#include "tests/support/programs_under_test.h"
#include "tests/support/temporary_folder.h"
#include "tools/simulators/site/controller_settings.h"
#include "tools/simulators/site/site_programs.h"

namespace bess {

struct FolderOfASite {
  TemporaryFolder folder;
};

class SimulatedSite : public FolderOfASite, public SitePrograms {
 public:
  static constexpr std::int64_t kStartS = 1'679'788'800;  ///< 2023-03-26T00:00:00Z

  /// Simulated time starts half a second from now. Without a simulated battery nothing listens on
  /// its port, which is this site's own: controllers lock it.
  explicit SimulatedSite(std::int32_t time_scale) : SitePrograms(sim_program(), folder.file("")) {
    battery_port = free_port();
    clock = {.anchor_utc_s = kStartS, .scale = time_scale};
    start_clock();
  }

  /// Resets the simulated clock to its start, for simulators that are restarted.
  void start_clock() { SitePrograms::start_clock(0.5); }
  [[nodiscard]] std::int64_t anchor_ns() const { return clock.anchor_monotonic_ns; }

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
  static std::string flat_prices(int minutes, double eur_per_mwh) {
    return minute_prices(minutes, {.mean_eur_per_mwh = eur_per_mwh, .amplitude_eur_per_mwh = 0});
  }

  /// `port` 0: any free one. A restarted simulator receives its previous port.
  void start_battery(const std::vector<std::string>& options = {}, int port = 0) {
    SitePrograms::start_battery(at(port, options));
  }
  void start_market(const std::vector<std::string>& options = {},
                    const std::string& prices = minute_prices(150), int port = 0) {
    std::vector<std::string> all = at(port, options);
    all.insert(all.end(), {"--prices", folder.write("minutes.csv", prices)});
    SitePrograms::start_market(all);
  }
  void start_both(int minutes = 150) {
    start_battery();
    start_market({}, minute_prices(minutes));
  }

  /// Lines of TOML for [battery]: the device, and its time-outs.
  static std::string alphaess_keys(int response_timeout_ms = 100) {
    return "map = \"" BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml\"\nresponse_timeout_ms = " +
           std::to_string(response_timeout_ms) + "\n";
  }

  struct ConfigOptions {
    std::string battery_keys = alphaess_keys() + "start_timeout_s = 1\n";  ///< all but the port
    std::string price_server = "http://127.0.0.1";                         ///< without its port
    std::string price_keys = "";  ///< lines of TOML for [price], in addition to the URL
    std::string guard_keys = "";  ///< lines of TOML
    std::string state = "state";  ///< folder; the file is named after it
    std::string state_keys = "";  ///< lines of TOML for [state]
  };

  [[nodiscard]] std::string write_config(const ConfigOptions& options) const {
    const std::string text = controller_settings(
        {.battery = options.battery_keys + "port = " + std::to_string(battery_port) + "\n",
         .market = options.price_server + ":" + std::to_string(market_port),
         .price = options.price_keys,
         .guard = options.guard_keys,
         .state = "folder = \"" + options.state + "\"\n" + options.state_keys,
         .clock = clock});
    return folder.write(options.state + ".toml", text);
  }
  [[nodiscard]] std::string write_config() const { return write_config(ConfigOptions{}); }

  /// The configuration after the required sign check.
  [[nodiscard]] std::string commission(const ConfigOptions& options) const {
    const std::string config = write_config(options);
    ChildProcess check({edge_program(), "commission", "--config", config, "--yes"});
    const std::string text = check.read_all();
    if (check.wait() != 0) throw std::runtime_error("the sign check failed: " + text);
    return config;
  }
  [[nodiscard]] std::string commission() const { return commission(ConfigOptions{}); }

 private:
  static std::vector<std::string> at(int port, std::vector<std::string> options) {
    if (port != 0) options.insert(options.end(), {"--port", std::to_string(port)});
    return options;
  }
};

}  // namespace bess
