#include "edge/notify/told.h"

#include <filesystem>
#include <fstream>
#include <sstream>

#include "edge/log/whole_file.h"
#include "shared/host/json.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kVersion = 1;

std::string text_of(JsonValue value) { return value.text_or(""); }

std::int64_t utc_of(JsonValue value) {
  std::int64_t utc_s = 0;
  static_cast<void>(parse_utc(text_of(value), utc_s));
  return utc_s;
}

Json alarm_json(const Alarm& alarm) {
  return Json::object({{"key", alarm.key},
                       {"text", alarm.text},
                       {"since_utc", utc_text(alarm.since_utc_s).view()},
                       {"seen_utc", utc_text(alarm.seen_utc_s).view()},
                       {"is_told", alarm.is_told}});
}

Json pending_json(const std::string& way, const Message& message) {
  return Json::object({{"way", way},
                       {"kind", kind_name(message.kind)},
                       {"key", message.key},
                       {"text", message.text},
                       {"utc", utc_text(message.utc_s).view()},
                       {"since_utc", utc_text(message.since_utc_s).view()}});
}

Json dropped_json(const std::string& way, const Dropped& dropped) {
  return Json::object({{"way", way},
                       {"count", dropped.count},
                       {"first_utc", utc_text(dropped.first_utc_s).view()},
                       {"last_utc", utc_text(dropped.last_utc_s).view()}});
}

template <typename Whole>
Whole whole_of(JsonValue value) {
  return static_cast<Whole>(value.number().value_or(0));
}

void read_owed(JsonValue all, std::map<std::string, Owed>& owed) {
  for (const JsonValue pending : all["pending"]) {
    owed[text_of(pending["way"])].messages.push_back({.kind = kind_of(text_of(pending["kind"])),
                                                      .key = text_of(pending["key"]),
                                                      .text = text_of(pending["text"]),
                                                      .utc_s = utc_of(pending["utc"]),
                                                      .since_utc_s = utc_of(pending["since_utc"])});
  }
  for (const JsonValue dropped : all["dropped"]) {
    owed[text_of(dropped["way"])].dropped = {.count = whole_of<int>(dropped["count"]),
                                             .first_utc_s = utc_of(dropped["first_utc"]),
                                             .last_utc_s = utc_of(dropped["last_utc"])};
  }
}

Json energy_json(const EnergyTotals& energy) {
  return Json::object({{"charged_ws", energy.charged_ws},
                       {"discharged_ws", energy.discharged_ws},
                       {"counted_number", energy.counted_number},
                       {"counted_utc_s", energy.counted_utc_s}});
}

EnergyTotals read_energy(JsonValue energy) {
  EnergyTotals totals;
  totals.charged_ws = whole_of<std::int64_t>(energy["charged_ws"]);
  totals.discharged_ws = whole_of<std::int64_t>(energy["discharged_ws"]);
  totals.counted_number = whole_of<std::uint64_t>(energy["counted_number"]);
  totals.counted_utc_s = whole_of<std::int64_t>(energy["counted_utc_s"]);
  return totals;
}

}  // namespace

Told read_told(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const Json json = Json::parse(text.str());
  const JsonValue all = json.value();
  Told told;
  if (all["version"].number().value_or(0) != kVersion) return told;
  told.local_day = whole_of<std::int32_t>(all["local_day"]);
  for (const JsonValue alarm : all["alarms"]) {
    told.alarms.push_back({.key = text_of(alarm["key"]),
                           .text = text_of(alarm["text"]),
                           .since_utc_s = utc_of(alarm["since_utc"]),
                           .seen_utc_s = utc_of(alarm["seen_utc"]),
                           .is_told = alarm["is_told"].boolean().value_or(false)});
  }
  read_owed(all, told.owed);
  told.energy = read_energy(all["energy"]);
  return told;
}

std::string told_text(const Told& told) {
  Json alarms = Json::list();
  Json pending = Json::list();
  Json dropped = Json::list();
  for (const Alarm& alarm : told.alarms) alarms.add(alarm_json(alarm));
  for (const auto& [way, owed] : told.owed) {
    for (const Message& message : owed.messages) pending.add(pending_json(way, message));
    if (owed.dropped.count > 0) dropped.add(dropped_json(way, owed.dropped));
  }
  return Json::object({{"version", kVersion},
                       {"local_day", told.local_day},
                       {"alarms", std::move(alarms)},
                       {"pending", std::move(pending)},
                       {"dropped", std::move(dropped)},
                       {"energy", energy_json(told.energy)}})
      .text();
}

bool write_told(const std::string& path, const std::string& text, std::string& error) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  if (make_folder(folder.c_str()) && replace_file_durably(path.c_str(), text)) return true;
  FileMessage message;
  fail_with_errno(path.c_str(), "cannot be written", message);
  error = message.view();
  return false;
}

}  // namespace bess
