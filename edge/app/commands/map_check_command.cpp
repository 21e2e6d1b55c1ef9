// Comparison of a register map with a recording of a device: `bess-edge map check`.
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <memory>

#include "edge/app/commands/command.h"
#include "edge/app/recording/energy_evidence.h"
#include "edge/app/recording/map_check.h"
#include "edge/device/battery/step_fit.h"
#include "edge/device/registers/map_file.h"
#include "shared/host/bus_recording.h"
#include "shared/host/json.h"

namespace bess {
namespace {

struct MapCheckOptions {
  std::string map_path;  ///< empty = the configuration's map
  std::string variant;
  std::string against_path;
  bool accept_cut = false;
  bool steps = false;
  bool json = false;
};

constexpr const char* kMapCheckFooter =
    R"(Lists each point with implausible values and a proposed correction: no answer, out of range,
wrong scale, word order or type; a state of charge that does not change or does not follow the
measured power; power against the order. The last three need a recording in which energy flowed.
Exit codes:
  0 all points plausible
  1 implausible points, or a file unreadable
  2 command line error
Examples:
  bess-edge map check --against inverter.jsonl --map edge/device/maps/sma.toml --variant setpoint
  bess-edge map check --against steps.jsonl --steps > steps.toml)";

/// Unit ids belong to an installation: those of the recording replace those of the map.
void take_units(const RecordingHead& head, RegisterMap& map) {
  for (UnitGroup& group : map.unit_groups) {
    for (const auto& [name, unit] : head.units) {
      if (group.name == name) group.unit = unit;
    }
  }
}

std::string place_text(const PointVerdict& point) {
  if (point.address < 0) return "-";
  return "unit " + std::to_string(point.unit) + " address " + std::to_string(point.address);
}

Json json_of(const PointVerdict& point) {
  Json json = Json::object({{"name", point.name}, {"unit", point.unit}});
  if (point.address >= 0) json.set("address", point.address);
  json.set("answers", point.answers);
  if (point.has_values) {
    json.set("min", point.value_min);
    json.set("max", point.value_max);
  }
  if (!point.finding.empty()) json.set("finding", point.finding);
  return json;
}

struct Result {
  std::vector<PointVerdict> points;
  std::string unjudged;
  std::int64_t exchanges = 0;
  std::int64_t findings = 0;
};

void print_json(const RegisterMap& map, const Result& result) {
  Json json = Json::object({{"map", map.name.view()},
                            {"variant", map.variant.view()},
                            {"exchanges", result.exchanges},
                            {"findings", result.findings},
                            {"points", Json::list_from(result.points, json_of)}});
  if (!result.unjudged.empty()) json.set("unjudged", result.unjudged);
  std::puts(json.line().c_str());
}

void print_text(const RegisterMap& map, const Result& result) {
  for (const PointVerdict& point : result.points) {
    if (point.finding.empty()) continue;
    std::printf("%-24s %-24s %s\n", point.name.c_str(), place_text(point).c_str(),
                point.finding.c_str());
  }
  if (!result.unjudged.empty()) std::printf("note: %s\n", result.unjudged.c_str());
  const std::string variant(map.variant.empty() ? "" : ", variant ");
  std::printf("%s%s%s: %" PRId64 " of %zu points are implausible, by %" PRId64 " exchanges\n",
              map.name.c_str(), variant.c_str(), map.variant.c_str(), result.findings,
              result.points.size(), result.exchanges);
}

/// A named map needs no configuration. Returns the exit code.
int find_map(const MapCheckOptions& options, SettingsFile& settings) {
  if (options.map_path.empty()) return load_settings(settings);
  std::string error;
  RegisterMap& map = settings.config.battery.map;
  return load_register_map(options.map_path, options.variant, map, error) ? 0 : failed(error);
}

/// Readings are 1 s apart. A shorter time is not resolved and counts as delay: a lag in full, the
/// ramp of the largest step by half.
constexpr double kRampS = 1;
constexpr double kLagS = 0.5;
constexpr double kSpare = 1.2;  ///< as commission proposes a settle_s

/// Prints keys of [battery], and a proposal for [response] of the map.
int print_steps(const MapCheckOptions& options, const RegisterMap& map,
                const RecordedSteps& steps) {
  const std::vector<const StepResponse*> whole = steps.whole();
  if (whole.empty()) {
    return failed(options.against_path + ": of " + std::to_string(steps.orders()) +
                  " set point steps none was recorded until its power was reached: record steps "
                  "with bess-edge commission --record FILE --yes");
  }
  const StepFit fit(whole);
  const auto [least, most] = std::ranges::minmax(whole, {}, &StepResponse::step_w);
  const double ramp_s = fit.best().ramp_s_per_w * most->step_w();
  const bool has_ramp = fit.has_ramp() && ramp_s >= kRampS;
  const double lag_s = fit.best().time_constant_s;
  const bool has_lag = lag_s >= kLagS;
  std::printf("[battery]   # %zu steps of %d to %d W\n", whole.size(), least->step_w(),
              most->step_w());
  std::printf("delay_s = %.2f\n",
              fit.best().dead_time_s + (has_ramp ? 0 : ramp_s / 2) + (has_lag ? 0 : lag_s));
  std::printf("ramp_w_per_s = %.0f%s\n", has_ramp ? 1 / fit.best().ramp_s_per_w : 0,
              has_ramp ? "" : "   # no certain ramp");
  std::printf("time_constant_s = %.2f\n", has_lag ? lag_s : 0);
  const double come_s = fit.seconds_until(most->step_w(), most->band_w()).most;
  std::printf("# %s, [response]: settle_s = %d, for %d W; now %d\n", map.name.c_str(),
              static_cast<int>(kSpare * come_s) + 1, most->step_w(), map.response.settle_s);
  return 0;
}

int run_map_check(const MapCheckOptions& options, SettingsFile& settings) {
  if (const int code = find_map(options, settings)) return code;
  RegisterMap& map = settings.config.battery.map;
  std::string error;
  BusRecordingReader recording;
  const CutRecording cut = options.accept_cut ? CutRecording::kAccepted : CutRecording::kRefused;
  if (!recording.open(options.against_path, cut, error)) return failed(error);
  take_units(recording.head(), map);
  const auto check = std::make_unique<MapCheck>(map, recording.head().unit);
  const auto steps =
      std::make_unique<RecordedSteps>(map, recording.head().unit, recording.head().time_scale);
  BusExchange exchange;
  auto next = recording.next(exchange, error);
  for (; next == BusRecordingReader::Next::kExchange; next = recording.next(exchange, error)) {
    check->add(exchange);
    steps->add(exchange);
  }
  if (next == BusRecordingReader::Next::kDamaged) return failed(error);
  if (options.steps) return print_steps(options, map, *steps);
  Result result{.points = check->verdicts(),
                .unjudged = check->unjudged(),
                .exchanges = recording.exchanges()};
  result.findings = std::count_if(result.points.begin(), result.points.end(),
                                  [](const PointVerdict& p) { return !p.finding.empty(); });
  if (options.json) {
    print_json(map, result);
  } else {
    print_text(map, result);
  }
  return result.findings == 0 ? 0 : 1;
}

}  // namespace

void add_map_check(EdgeCommand root) {
  EdgeCommand map = root.subcommand("map", "check a register map");
  map.requires_subcommand();
  EdgeCommand command =
      map.subcommand("check", "compare a register map with a recording of a battery");
  const auto options = std::make_shared<MapCheckOptions>();
  command.option("--against", options->against_path, "recording of bess-edge record or --record")
      .value_name("FILE")
      .required();
  command.option("--map", options->map_path, "register map; default: the map of the configuration")
      .value_name("FILE");
  command.option("--variant", options->variant, "variant of the map; default: the first")
      .value_name("NAME")
      .needs("--map");
  command.config().excludes("--map");
  command.flag("--accept-cut", options->accept_cut,
               "accept a recording whose last line is incomplete");
  command.flag("--json", options->json, "one JSON object");
  command
      .flag("--steps", options->steps,
            "print the fitted step response as [battery] in TOML for bess-train and bess-sim")
      .excludes("--json");
  command.footer(kMapCheckFooter);
  command.does_without_settings(
      [options](SettingsFile& settings) { return run_map_check(*options, settings); });
}

}  // namespace bess
