#include "edge/companions/notify/notifier_state.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "edge/companions/notify/topics.h"
#include "edge/records/log/atomic_file.h"
#include "shared/host/json.h"
#include "shared/utc_text.h"

namespace bess {

std::vector<AlertEvent> observe(std::vector<ToldAlert>& alerts, const std::vector<SeenAlert>& seen,
                                std::int64_t after_s, std::int64_t now_utc_s) {
  std::vector<AlertEvent> events;
  for (ToldAlert& alert : alerts) {  // a clock set back must not suppress an alert
    alert.since_utc_s = std::min(alert.since_utc_s, now_utc_s);
    alert.seen_utc_s = std::min(alert.seen_utc_s, now_utc_s);
  }
  for (const SeenAlert& seen_now : seen) {
    auto alert = std::ranges::find(alerts, seen_now.key, &ToldAlert::key);
    if (alert == alerts.end()) {
      alert = alerts.insert(alert, {.key = seen_now.key, .since_utc_s = now_utc_s});
    }
    alert->text = seen_now.text;
    alert->seen_utc_s = now_utc_s;
    if (alert->is_told || now_utc_s - alert->since_utc_s < after_s) continue;
    alert->is_told = true;
    events.push_back({.is_over = false, .alert = *alert});
  }
  std::erase_if(alerts, [&](const ToldAlert& alert) {
    // Strictly longer than 0; else with after_s = 0 an alert just seen would be over.
    const std::int64_t away_s = now_utc_s - alert.seen_utc_s;
    if (away_s == 0 || away_s < after_s) return false;
    if (alert.is_told) events.push_back({.is_over = true, .alert = alert});
    return true;
  });
  return events;
}

namespace {

constexpr int kVersion = 1;

std::int64_t utc_of(JsonValue value) {
  std::int64_t utc_s = 0;
  static_cast<void>(parse_utc(value.text_or(""), utc_s));
  return utc_s;
}

NotifierState state_in(JsonValue all) {
  NotifierState state{.number = static_cast<std::uint64_t>(all["number"].number().value_or(0)),
                      .day = all["day"].text_or("")};
  for (const JsonValue alert : all["alarms"]) {
    state.alerts.push_back({.key = alert["key"].text_or(""),
                            .text = alert["text"].text_or(""),
                            .since_utc_s = utc_of(alert["since_utc"]),
                            .seen_utc_s = utc_of(alert["seen_utc"]),
                            .is_told = alert["is_told"].boolean().value_or(false)});
  }
  for (const JsonValue message : all["pending"]) {
    state.pending.push_back({.severity = message["kind"].text_or(""),
                             .key = message["key"].text_or(""),
                             .text = message["text"].text_or(""),
                             .utc_s = utc_of(message["utc"]),
                             .since_utc_s = utc_of(message["since_utc"])});
  }
  return state;
}

/// False with errno; 0 if damaged.
bool read_place(const std::string& path, NotifierState& state) {
  constexpr std::size_t kBytesMax = 4 * 1024 * 1024;  // 20 times the size of 200 messages
  std::string text(kBytesMax, '\0');
  const ssize_t size = read_beginning(path.c_str(), text, SymlinkPolicy::kRefused);
  if (size < 0) return false;
  text.resize(static_cast<std::size_t>(size));
  errno = 0;
  const Json json = Json::parse(text);  // older versions wrote no checksum
  const bool is_broken = check_text(text, kJsonChecksum) == ChecksumState::kBroken;
  if (is_broken || json.value()["version"].number() != kVersion) return false;
  state = state_in(json.value());
  return true;
}

}  // namespace

NotifierState read_notifier_state(const std::vector<std::string>& paths,
                                  std::vector<std::string>& losses) {
  NotifierState newest;
  bool is_known = false;
  for (const std::string& path : paths) {
    NotifierState state;
    if (read_place(path, state)) {
      if (!is_known || state.number > newest.number) newest = std::move(state);
      is_known = true;
    } else if (errno != ENOENT) {
      losses.push_back(path + (errno == 0 ? " is damaged or of another version: ignored"
                                          : std::string(" cannot be read: ") + strerror(errno)));
    }
  }
  if (!is_known && !losses.empty()) {
    losses.emplace_back("reported alerts unknown: current alerts are reported again");
  }
  return newest;
}

std::string notifier_state_text(const NotifierState& state) {
  const auto told_json = [](const ToldAlert& alert) {
    Json json = alert_json(alert);
    json.set("seen_utc", utc_text(alert.seen_utc_s).view());
    json.set("is_told", alert.is_told);
    return json;
  };
  const auto pending_json = [](const Message& message) { return event_json("", message); };
  const std::string text = Json::object({{"version", kVersion},
                                         {"number", state.number},
                                         {"day", state.day},
                                         {"alarms", Json::list_from(state.alerts, told_json)},
                                         {"pending", Json::list_from(state.pending, pending_json)}})
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
  return trouble + (kept.empty() ? "; notifier state not stored: a restart repeats alerts"
                                 : "; notifier state stored only in " + kept);
}

}  // namespace bess
