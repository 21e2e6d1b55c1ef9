#include "edge/notify/notifier.h"

#include <algorithm>

#include "edge/control/cycle_budget.h"
#include "edge/log/ring_log.h"
#include "edge/notify/day_account.h"
#include "edge/notify/journal_line.h"
#include "edge/notify/mail.h"
#include "edge/notify/topics.h"
#include "edge/notify/webhook.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kPatienceS = 3 * 86'400;
constexpr std::size_t kPendingMax = 200;
constexpr int kDaysMax = 7;  ///< told at once, after the notifier was away

std::int32_t local_day_at(std::int64_t utc_s) { return local_day_of(local_minute_of(utc_s)); }

/// The days before `today` that were not told, oldest first, from the newest records backwards.
std::vector<DayAccount> accounts_of_days(const std::string& ring_path, std::int32_t told_day,
                                         std::int32_t today) {
  RingLog ring;
  FileMessage ignored;
  std::map<std::int32_t, DayAccount> days;
  if (!ring.open_to_read(ring_path.c_str(), ignored)) return {};
  CycleRecord record;
  for (std::uint64_t n = ring.newest_number(); n >= ring.oldest_number() && n > 0; --n) {
    if (!ring.read(n, record)) continue;
    const std::int32_t day = local_day_at(record.utc_s);
    if (day <= told_day) break;
    if (day < today) days.try_emplace(day, day).first->second.add(record);
  }
  std::vector<DayAccount> accounts;
  for (const auto& [day, account] : days) {
    if (!account.is_empty()) accounts.push_back(account);
  }
  if (accounts.size() > kDaysMax) accounts.erase(accounts.begin(), accounts.end() - kDaysMax);
  return accounts;
}

std::string duration_text(std::int64_t seconds) {
  if (seconds < 120) return std::to_string(seconds) + " s";
  if (seconds < 7'200) return std::to_string(seconds / 60) + " min";
  return std::to_string(seconds / 3'600) + " h";
}

}  // namespace

Notifier::Notifier(const NotifySettings& settings)
    : settings_(settings),
      told_(read_told(settings.memory)),
      book_(settings.after_s, told_.alarms) {
  if (!settings_.mail_to.empty()) {
    ways_["mail"] = [this](const Message& message) { return send_mail(settings_, message); };
  }
  if (!settings_.webhook_url.empty()) {
    ways_["webhook"] = [this](const Message& message) { return post_webhook(settings_, message); };
  }
  if (settings_.mqtt.host.empty()) return;
  mqtt_ = std::make_unique<MqttClient>(settings_.mqtt, settings_.node);
  if (!settings_.mqtt.discovery_prefix.empty()) {
    mqtt_->retain(discovery_topic(settings_), discovery_json(settings_, BESS_VERSION));
  }
  ways_["mqtt"] = [this](const Message& message) {
    if (!mqtt_->trouble().empty()) return mqtt_->trouble();
    return mqtt_->send(topic(settings_.node, "event"), message_json(settings_.node, message));
  };
}

void Notifier::run_round(std::int64_t now_utc_s) {
  const ControllerStatus status = ask_controller(settings_.program, settings_.config_path);
  tell_events(book_.observe(troubles_of(status), now_utc_s), now_utc_s);
  tell_days(status, now_utc_s);
  publish(status);
  keep();  // before it is sent: killed in between, a message is sent late and not never
  const std::size_t pending = told_.pending.size();
  deliver(now_utc_s);
  if (told_.pending.size() != pending) keep();
}

bool Notifier::send_test(std::int64_t now_utc_s) {
  bool all = true;
  for (const auto& [name, way] : ways_) {
    const std::string trouble = way({.kind = MessageKind::kTest,
                                     .key = "test",
                                     .text = "bess-notify can reach you by " + name,
                                     .utc_s = now_utc_s});
    all = all && trouble.empty();
    say(trouble.empty() ? JournalLevel::kInfo : JournalLevel::kError,
        trouble.empty() ? name + ": sent" : trouble);
  }
  return all;
}

void Notifier::tell(const Message& message) {
  say(message.kind == MessageKind::kAlarm ? JournalLevel::kWarning : JournalLevel::kNotice,
      headline(message));
  for (const auto& [name, way] : ways_) told_.pending.push_back({name, message});
  if (told_.pending.size() <= kPendingMax) return;
  told_.pending.erase(told_.pending.begin(), told_.pending.end() - kPendingMax);
}

void Notifier::tell_events(const std::vector<AlarmEvent>& events, std::int64_t now_utc_s) {
  for (const auto& [is_over, alarm] : events) {
    Message message{.kind = is_over ? MessageKind::kOver : MessageKind::kAlarm,
                    .key = alarm.key,
                    .text = alarm.text,
                    .utc_s = now_utc_s,
                    .since_utc_s = alarm.since_utc_s};
    if (is_over) {
      message.text += " (lasted " + duration_text(alarm.seen_utc_s - alarm.since_utc_s) + ")";
    }
    tell(message);
  }
}

/// By the controller's own time: its newest record begins the new day.
void Notifier::tell_days(const ControllerStatus& status, std::int64_t now_utc_s) {
  const char* const newest = status.json.value()["last"]["utc"].text();
  std::int64_t newest_utc_s = 0;
  if (!settings_.daily || newest == nullptr || !parse_utc(newest, newest_utc_s)) return;
  const bool has_cycles = status.json.value()["totals"]["cycles"].number().value_or(0) > 0;
  if (!has_cycles || newest_utc_s == 0) return;
  const std::int32_t today = local_day_at(newest_utc_s);
  const std::int32_t yesterday = local_day_at(newest_utc_s - 86'400);
  if (told_.local_day == 0) told_.local_day = yesterday;     // the days before were not watched
  if (told_.local_day > today) told_.local_day = yesterday;  // told while the clock was wrong
  if (told_.local_day >= yesterday) return;
  for (const DayAccount& day : accounts_of_days(settings_.ring, told_.local_day, today)) {
    tell({.kind = MessageKind::kDay, .key = day.date(), .text = day.line(), .utc_s = now_utc_s});
    if (mqtt_ != nullptr) mqtt_->retain(topic(settings_.node, "day"), day_json(day));
  }
  told_.local_day = yesterday;
}

void Notifier::deliver(std::int64_t now_utc_s) {
  std::vector<Pending> left;
  std::map<std::string, std::string> troubles;
  for (Pending& pending : told_.pending) {
    const auto way = ways_.find(pending.way);
    const bool is_too_old = now_utc_s - pending.message.utc_s > kPatienceS;
    if (way == ways_.end() || is_too_old) continue;
    // A way that has just failed would only cost its time-out again.
    const bool has_failed = troubles.contains(pending.way);
    const std::string trouble = has_failed ? troubles[pending.way] : way->second(pending.message);
    if (trouble.empty()) continue;
    troubles[pending.way] = trouble;
    left.push_back(std::move(pending));
  }
  told_.pending = std::move(left);
  for (const auto& [name, trouble] : troubles) {
    if (trouble_of_way_[name] == trouble) continue;
    say(JournalLevel::kWarning, trouble + "; tried again every round");
  }
  trouble_of_way_ = std::move(troubles);
}

void Notifier::publish(const ControllerStatus& status) {
  if (mqtt_ == nullptr) return;
  const std::vector<Alarm>& alarms = book_.alarms();
  const auto told =
      std::count_if(alarms.begin(), alarms.end(), [](const Alarm& alarm) { return alarm.is_told; });
  mqtt_->retain(topic(settings_.node, "state"), state_json(status, static_cast<std::size_t>(told)));
  mqtt_->retain(topic(settings_.node, "alarms"), alarms_json(alarms));
}

void Notifier::keep() {
  told_.alarms = book_.alarms();
  std::string error;
  const bool is_kept = write_told(settings_.memory, told_, error);
  if (!is_kept && !is_memory_failing_) {
    say(JournalLevel::kWarning, error + "; a restart will tell again what was told");
  }
  is_memory_failing_ = !is_kept;
}

}  // namespace bess
