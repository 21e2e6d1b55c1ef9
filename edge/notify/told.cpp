#include "edge/notify/told.h"

#include <sys/stat.h>

#include <cerrno>
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

Json pending_json(const Pending& pending) {
  return Json::object({{"way", pending.way},
                       {"kind", kind_name(pending.message.kind)},
                       {"key", pending.message.key},
                       {"text", pending.message.text},
                       {"utc", utc_text(pending.message.utc_s).view()},
                       {"since_utc", utc_text(pending.message.since_utc_s).view()}});
}

}  // namespace

Told read_told(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const Json json = Json::parse(text.str());
  const JsonValue all = json.value();
  Told told;
  if (all["version"].number().value_or(0) != kVersion) return told;
  told.local_day = static_cast<std::int32_t>(all["local_day"].number().value_or(0));
  for (const JsonValue alarm : all["alarms"]) {
    told.alarms.push_back({.key = text_of(alarm["key"]),
                           .text = text_of(alarm["text"]),
                           .since_utc_s = utc_of(alarm["since_utc"]),
                           .seen_utc_s = utc_of(alarm["seen_utc"]),
                           .is_told = alarm["is_told"].boolean().value_or(false)});
  }
  for (const JsonValue pending : all["pending"]) {
    told.pending.push_back({.way = text_of(pending["way"]),
                            .message = {.kind = kind_of(text_of(pending["kind"])),
                                        .key = text_of(pending["key"]),
                                        .text = text_of(pending["text"]),
                                        .utc_s = utc_of(pending["utc"]),
                                        .since_utc_s = utc_of(pending["since_utc"])}});
  }
  return told;
}

bool write_told(const std::string& path, const Told& told, std::string& error) {
  Json alarms = Json::list();
  for (const Alarm& alarm : told.alarms) alarms.add(alarm_json(alarm));
  Json pending = Json::list();
  for (const Pending& owed : told.pending) pending.add(pending_json(owed));
  const Json json = Json::object({{"version", kVersion},
                                  {"local_day", told.local_day},
                                  {"alarms", std::move(alarms)},
                                  {"pending", std::move(pending)}});
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const bool has_folder = mkdir(folder.c_str(), 0755) == 0 || errno == EEXIST;
  if (has_folder && replace_file_durably(path.c_str(), json.text())) return true;
  FileMessage message;
  fail_with_errno(path.c_str(), "cannot be written", message);
  error = message.view();
  return false;
}

}  // namespace bess
