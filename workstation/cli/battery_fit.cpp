// bess-train battery fit: battery parameters from a controller's log.
#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "shared/battery_keys.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/data/env/battery_fit.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {
namespace {

struct FitArguments {
  std::vector<std::string> logs;
  std::string steps;
  std::string config;
  std::string out;
  bool json = false;
};

/// Takes delay, ramp and lag from the output of `bess-edge map check --steps`.
void take_steps(const std::string& path, BatteryParameters& battery) {
  std::string error;
  TomlValue document;
  if (!parse_toml_file(path, document, error)) throw UserError(error);
  if (document.find("battery") == nullptr) {
    fail("{}: no [battery]: use the output of bess-edge map check --steps", path);
  }
  TomlTable table(document.find("battery"), path, "[battery]", error);
  for (const BatteryKey& key : kBatteryKeys) {
    const std::string_view name = key.name;
    if (name != "delay_s" && name != "ramp_w_per_s" && name != "time_constant_s") continue;
    table.require(key.name);
    table.number(key.name, key.of(battery), key.low, key.high);
  }
  table.finish();
  if (!error.empty()) throw UserError(error);
}

/// A complete configuration: [battery] with what was fitted, then every other key that `config`
/// changes, so that costs, wear and limits are not lost.
std::string toml_of(const BatteryFit& fit, const RunConfig& config) {
  BatteryParameters battery = with_fit(config.battery, fit);
  std::string section = "[battery]";
  std::string text = section + "\n";
  for (const BatteryKey& key : kBatteryKeys) {
    text += fmt::format("{} = {:.6g}", key.name, key.of(battery));
    if (const auto found = fit.find(key.name); found != fit.end()) {
      const Fitted& value = found->second;
      text += fmt::format("  # +- {:.2g}, from {}", value.standard_error, value.observations);
    }
    text += "\n";
  }
  for (const ChangedKey& changed : changed_keys(config)) {
    const std::size_t end = changed.key.find(' ');
    const std::string name = changed.key.substr(end + 1);
    const bool in_battery = changed.key.starts_with("[battery] ");
    const bool fitted =
        std::ranges::find(kBatteryKeys, name, &BatteryKey::name) != kBatteryKeys.end();
    if (in_battery && fitted) continue;
    if (!changed.key.starts_with(section + " ")) {
      section = changed.key.substr(0, end);
      text += fmt::format("\n{}\n", section);
    }
    text += fmt::format("{} = {}\n", name, changed.value);
  }
  return text;
}

void print_found(const BatteryFit& fit, bool json) {
  for (const BatteryKey& key : kBatteryKeys) {
    const auto found = fit.find(key.name);
    if (found == fit.end()) continue;
    const Fitted& value = found->second;
    if (!json) {
      fmt::print("{:<22} {:>9.5g} +- {:<9.2g} from {}\n", key.name, value.value,
                 value.standard_error, value.observations);
      continue;
    }
    const Json line = answer("battery_key", {{"key", key.name},
                                             {"value", Decimals{value.value, 6}},
                                             {"standard_error", Decimals{value.standard_error, 6}},
                                             {"observations", value.observations}});
    fmt::print("{}\n", line.line());
  }
}

BatteryFit fit_from_logs(const FitArguments& options, const BatteryParameters& nameplate) {
  if (options.logs.empty()) return {};
  std::vector<LoggedCycle> cycles = read_cycle_log(options.logs).cycles;
  std::erase_if(cycles, [](const LoggedCycle& cycle) { return !cycle.has_reading; });
  const BatteryFit fit = fit_battery(cycles, nameplate);
  if (fit.empty()) {
    fail(
        "{}: {} control cycles are too few to fit the battery: use several days with orders in "
        "both directions and idle cycles between them",
        options.logs.front(), cycles.size());
  }
  return fit;
}

void write_fit(const FitArguments& options) {
  if (options.logs.empty() && options.steps.empty()) fail("battery fit needs --log or --steps");
  require_distinct({{"--out", options.out}},
                   named_paths("--log", options.logs,
                               {{"--config", options.config}, {"--steps", options.steps}}));
  RunConfig config = load_run_config(options.config);
  if (!options.steps.empty()) take_steps(options.steps, config.battery);
  const BatteryFit fit = fit_from_logs(options, config.battery);
  print_found(fit, options.json);
  if (options.out.empty()) return;
  write_file(options.out, toml_of(fit, config));
  if (!options.json) fmt::print("{}\n", options.out);
}

}  // namespace

void add_battery_commands(ProgramCommand& app) {
  ProgramCommand battery = app.subcommand("battery", "battery parameters from measurements: fit");
  battery.requires_subcommand();
  auto options = std::make_shared<FitArguments>();
  ProgramCommand command = battery.subcommand(
      "fit", "fit efficiency, taper, cold limits and standby power to a controller's log");
  command.option("--log", options->logs,
                 "controller logs (bess-edge log --csv); several are joined");
  command.option("--steps", options->steps,
                 "step response from bess-edge map check --steps; copied to --out");
  command.option(
      "--config", options->config,
      "configuration with the nameplate values in [battery] (default: the default battery)");
  command.option("--out", options->out,
                 "output file: the configuration with the fitted [battery], for --config and for "
                 "bess-sim battery --battery");
  command.flag("--json", options->json, "JSON, one line per key");
  command.footer(
      "Values that the log cannot show keep the value of --config: standby power needs idle\n"
      "cycles, cold limits need cold days. Delay, ramp and lag need readings within a control\n"
      "cycle: bess-edge commission --record takes them.\n"
      "Examples:\n"
      "  bess-edge log --csv > june.csv     # on the controller\n"
      "  bess-edge commission --record steps.jsonl --yes && \\\n"
      "    bess-edge map check --against steps.jsonl --steps > steps.toml\n"
      "  bess-train battery fit --log june.csv --steps steps.toml --config house.toml --out "
      "battery.toml\n"
      "  bess-train evaluate --prices market.csv.gz --config battery.toml --policy sdp");
  command.runs([options] { write_fit(*options); });
}

}  // namespace bess
