// bess-sim site: testbed of battery, market and controller configuration in one folder.
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "tools/simulators/sim/clock_options.h"
#include "tools/simulators/sim/commands.h"
#include "tools/simulators/sim/stop_signal.h"
#include "tools/simulators/site/controller_settings.h"
#include "tools/simulators/site/site_programs.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

struct SiteOptions {
  std::string folder, prices, day_ahead, map, program;
  ClockOptions clock;
  double in_s = 2;
  std::string battery, market;        ///< options passed to them
  std::vector<std::string> settings;  ///< TABLE.KEY=VALUE
  bool is_watching = false;
};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

/// Keys and values by their table; later ones replace earlier ones.
using Tables = std::map<std::string, std::map<std::string, std::string>>;

void set(Tables& tables, const std::string& text) {
  const std::size_t dot = text.find('.'), equals = text.find('=');
  const std::string table = text.substr(0, dot);
  if (dot == std::string::npos || equals == std::string::npos || equals < dot ||
      !tables.contains(table)) {
    fail(
        "--set {}: use TABLE.KEY=VALUE with table battery, price, outlook, guard, meter, limits or "
        "state",
        text);
  }
  tables[table][text.substr(dot + 1, equals - dot - 1)] = text.substr(equals + 1);
}

std::string lines_of(const std::map<std::string, std::string>& table) {
  std::string text;
  for (const auto& [key, value] : table) text += key + " = " + value + "\n";
  return text;
}

std::string quoted(const std::string& text) { return '"' + text + '"'; }

std::string settings_of(const SiteOptions& options, const SitePrograms& programs) {
  Tables tables = {{"battery",
                    {{"map", quoted(fs::absolute(options.map).string())},
                     {"port", std::to_string(programs.battery_port)},
                     {"response_timeout_ms", "200"}}},
                   {"price", {{"history_hours", "0"}}},
                   {"outlook", {}},
                   {"guard", {}},
                   {"meter", {}},
                   {"limits", {}},
                   {"state", {{"folder", quoted("state")}}}};
  for (const std::string& text : options.settings) set(tables, text);
  const std::string market = "http://127.0.0.1:" + std::to_string(programs.market_port);
  auto& outlook = tables["outlook"];  // only when a key of it is set
  if (!outlook.empty()) {
    outlook.emplace("url", quoted(market + "/price?bzn=BE"));
  }
  std::string more;  // tables with a key set
  for (const char* const name : {"outlook", "meter", "limits"}) {
    if (!tables[name].empty()) more += "[" + std::string(name) + "]\n" + lines_of(tables[name]);
  }
  return controller_settings({.control = !options.is_watching,
                              .battery = lines_of(tables["battery"]),
                              .market = market,
                              .price = lines_of(tables["price"]),
                              .guard = lines_of(tables["guard"]),
                              .state = lines_of(tables["state"]),
                              .tables = more,
                              .clock = programs.clock});
}

void run_site(const SiteOptions& options) {
  const StopSignal stop;
  fs::create_directories(options.folder);
  if (options.clock.utc_start.empty())
    fail("--utc-start is missing: bess-sim site needs a simulated clock");
  const ScaledClock clock = options.clock.clock();
  const std::string program =
      options.program.empty() ? fs::read_symlink("/proc/self/exe").string() : options.program;
  SitePrograms programs(program, options.folder);
  fs::remove(programs.file("edge.toml"));  // of an earlier run; its presence shows that both listen
  programs.clock = clock;
  if (options.clock.anchor_monotonic_ns == 0) programs.start_clock(options.in_s);
  std::vector<std::string> battery = words_of(options.battery);
  battery.insert(battery.begin(), {"--map", options.map});
  programs.start_battery(battery);
  std::vector<std::string> market = words_of(options.market);
  market.insert(market.begin(), {"--prices", options.prices});
  if (!options.day_ahead.empty()) market.insert(market.end(), {"--day-ahead", options.day_ahead});
  programs.start_market(market);
  const std::string path = programs.file("edge.toml");
  write_file(path, settings_of(options, programs));
  std::printf("bess-sim site: battery at 127.0.0.1:%d, market at 127.0.0.1:%d, settings %s\n",
              programs.battery_port, programs.market_port, path.c_str());
  std::fflush(stdout);
  stop.wait();
  const int battery_code = SitePrograms::stop(*programs.battery);
  const int market_code = SitePrograms::stop(*programs.market);
  if (battery_code != 0) fail("{}", last_line_of(programs.log_of("battery")));
  if (market_code != 0) fail("{}", last_line_of(programs.log_of("market")));
  std::printf("bess-sim site: stopped\n");
}

}  // namespace

void add_site_command(ProgramCommand& app) {
  auto options = std::make_shared<SiteOptions>();
  ProgramCommand command =
      app.subcommand("site", "start a battery, a market and a matching configuration of bess-edge");
  command.footer(
      "Examples:\n"
      "  bess-sim site --folder site --prices minutes.csv --map edge/device/maps/alphaess.toml "
      "--utc-start 2023-03-26T00:00:00Z --time-scale 900\n"
      "  bess-edge commission --config site/edge.toml --yes\n"
      "  bess-prices --config site/edge.toml &\n"
      "  bess-edge --config site/edge.toml --cycles 50\n"
      "  bess-sim site --folder site --prices minutes.csv --map edge/device/maps/alphaess.toml "
      "--utc-start 2023-03-26T00:00:00Z \\\n"
      "    --battery \"--soc 0.3 --house daily\" --market \"--fault all --fault-every 7\" "
      "--set guard.soc_min=0.2\n"
      "Files in the folder: edge.toml once both listen, battery.csv and orders.csv at the end, and "
      "their logs.\n"
      "Exit codes: 0 stopped, 1 bad input or port in use, 2 bad command line.");
  command.option("--folder", options->folder, "output folder").required();
  command.option("--prices", options->prices, "minute file with the prices, CSV or .csv.gz")
      .required();
  command.option("--day-ahead", options->day_ahead,
                 "day-ahead file that the market publishes as well");
  command.option("--map", options->map, "register map of the battery (TOML)").required();
  options->clock.add_to(command);
  command.option("--in-s", options->in_s, "delay until simulated time begins, s")
      .range(0.0, 1.0 * kSecondsPerDay)
      .with_default();
  command.option("--battery", options->battery,
                 "options passed to bess-sim battery, one quoted argument");
  command.option("--market", options->market,
                 "options passed to bess-sim market, one quoted argument");
  command.option("--set", options->settings, "key of edge.toml, e.g. guard.soc_max=0.9")
      .value_name("TABLE.KEY=VALUE");
  command.option("--program", options->program, "path of bess-sim (default: this program)");
  command.flag("--no-control", options->is_watching, "read-only controller (control = false)");
  command.runs([options] { run_site(*options); });
}

}  // namespace bess
