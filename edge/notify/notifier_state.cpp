#include "edge/notify/notifier_state.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "edge/log/text_checksum.h"
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

/// What lies at one of the places.
struct KeptTold {
  std::string path;
  NotifierState told{};
  std::string loss{};  ///< why it does not count
  bool is_absent = false;

  [[nodiscard]] bool counts() const { return !is_absent && loss.empty(); }
};

NotifierState notifier_state_in(JsonValue all) {
  NotifierState told;
  told.number = whole_of<std::uint64_t>(all["number"]);
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

KeptTold read_place(const std::string& path) {
  constexpr std::size_t kBytesMax =
      4 * 1024 * 1024;  // two ways that owe 200 messages each need a tenth
  KeptTold place{.path = path};
  std::string text(kBytesMax, '\0');
  const ssize_t size = read_beginning(path.c_str(), text, Links::kRefused);
  if (size < 0) {
    place.is_absent = errno == ENOENT;
    if (!place.is_absent) place.loss = std::string("cannot be read: ") + std::strerror(errno);
    return place;
  }
  text.resize(static_cast<std::size_t>(size));
  const Json json = Json::parse(text);  // one of an older program has no checksum
  const bool is_broken = check_text(text, kJsonChecksum) == TextState::kBroken;
  if (is_broken || json.value()["version"].number().value_or(0) != kVersion) {
    place.loss = "is damaged, or of another version: not believed";
    return place;
  }
  place.told = notifier_state_in(json.value());
  return place;
}

}  // namespace

NotifierStateReading read_newest_notifier_state(const std::vector<std::string>& paths) {
  NotifierStateReading reading;
  std::vector<KeptTold> places;
  for (const std::string& path : paths) places.push_back(read_place(path));
  for (KeptTold& place : places) {
    if (!place.loss.empty()) reading.losses.push_back(place.path + " " + place.loss);
    if (!place.counts() || place.told.number < reading.told.number) continue;
    reading.told = place.told;
  }
  const bool is_any =
      std::any_of(places.begin(), places.end(), [](const KeptTold& p) { return p.counts(); });
  if (!is_any && !reading.losses.empty()) {
    reading.losses.emplace_back(
        "what was told is not known: alarms are told again, days and energy are counted anew");
  }
  const auto folder = [](const std::string& path) {
    return std::string(folder_of(path.c_str()).view());
  };
  for (const KeptTold& place :
       places) {  // that of another folder is in memory, which a boot empties
    const bool is_gone =
        place.is_absent && reading.told.number > 0 && folder(place.path) == folder(paths.front());
    if (is_gone) reading.losses.push_back(place.path + " is gone; another copy counts");
  }
  return reading;
}

std::string notifier_state_text(const NotifierState& told) {
  Json alarms = Json::list();
  Json pending = Json::list();
  Json dropped = Json::list();
  for (const Alarm& alarm : told.alarms) alarms.add(alarm_json(alarm));
  for (const auto& [way, owed] : told.owed) {
    for (const Message& message : owed.messages) pending.add(pending_json(way, message));
    if (owed.dropped.count > 0) dropped.add(dropped_json(way, owed.dropped));
  }
  const std::string text = Json::object({{"version", kVersion},
                                         {"number", told.number},
                                         {"local_day", told.local_day},
                                         {"alarms", std::move(alarms)},
                                         {"pending", std::move(pending)},
                                         {"dropped", std::move(dropped)},
                                         {"energy", energy_json(told.energy)}})
                               .text();
  const std::string body = text.substr(0, text.rfind("\n}"));
  return body + std::string(checksum_end(body, kJsonChecksum).view());
}

std::string write_notifier_state(const std::vector<std::string>& paths, const std::string& text) {
  std::string trouble;
  std::string kept;
  for (const std::string& path : paths) {
    if (make_folder(folder_of(path.c_str()).c_str()) && replace_file_durably(path.c_str(), text)) {
      kept = path;
      continue;
    }
    FileMessage message;
    fail_with_errno(path.c_str(), "cannot be written", message);
    if (trouble.empty()) trouble = message.view();
  }
  if (trouble.empty()) return "";
  return trouble + (kept.empty() ? "; what is told is kept nowhere: a restart tells it again"
                                 : "; what is told is kept in " + kept + " alone");
}

}  // namespace bess
