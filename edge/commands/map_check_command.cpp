#include "edge/commands/map_check_command.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "edge/log/journal.h"
#include "edge/recording/map_check.h"
#include "edge/registers/map_file.h"
#include "shared/host/bus_recording.h"
#include "shared/host/json.h"

namespace bess {
namespace {

int refuse(const std::string& error) {
  report(JournalLevel::kError, "%s", error.c_str());
  return 1;
}

/// Unit ids are the recorded device's, not the map's: they are settings of an installation.
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
  Json points = Json::list();
  for (const PointVerdict& point : result.points) points.add(json_of(point));
  Json json = Json::object({{"map", map.name.view()},
                            {"variant", map.variant.view()},
                            {"exchanges", result.exchanges},
                            {"findings", result.findings},
                            {"points", std::move(points)}});
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

}  // namespace

int run_map_check_command(const CommandLine& command_line, const EdgeConfig* config) {
  static RegisterMap map;
  std::string error;
  if (config != nullptr) {
    map = config->map;
  } else if (!load_register_map(command_line.map_path, command_line.variant, map, error)) {
    return refuse(error);
  }
  BusRecordingReader recording;
  const CutRecording cut =
      command_line.accept_cut ? CutRecording::kAccepted : CutRecording::kRefused;
  if (!recording.open(command_line.against_path, cut, error)) return refuse(error);
  take_units(recording.head(), map);
  static MapCheck check(map, recording.head().unit);
  BusExchange exchange;
  auto next = recording.next(exchange, error);
  for (; next == BusRecordingReader::Next::kExchange; next = recording.next(exchange, error)) {
    check.add(exchange);
  }
  if (next == BusRecordingReader::Next::kDamaged) return refuse(error);
  Result result{
      .points = check.verdicts(), .unjudged = check.unjudged(), .exchanges = recording.exchanges()};
  result.findings = std::count_if(result.points.begin(), result.points.end(),
                                  [](const PointVerdict& p) { return !p.finding.empty(); });
  command_line.json ? print_json(map, result) : print_text(map, result);
  return result.findings == 0 ? 0 : 1;
}

}  // namespace bess
