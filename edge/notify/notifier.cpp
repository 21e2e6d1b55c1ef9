#include "edge/notify/notifier.h"

#include <algorithm>
#include <utility>

#include "edge/account/account_days.h"
#include "edge/control/cycle_budget.h"
#include "edge/log/log_reader.h"
#include "edge/notify/alarm_command.h"
#include "edge/notify/journal_line.h"
#include "edge/notify/topics.h"
#include "shared/host/run_program.h"
#include "shared/local_day.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kDaysMax = 7;  ///< told at once, after the notifier was away
constexpr std::int64_t kOrderS = 10;
constexpr std::int64_t kKeepEnergyEveryS = 3'600;

/// 0 when no cycle has ended yet.
std::int64_t newest_utc_of(const ControllerStatus& status) {
  std::int64_t utc_s = 0;
  const JsonValue all = status.json.value();
  const char* const text = all["last"]["utc"].text();
  const bool has_cycles = all["totals"]["cycles"].number().value_or(0) > 0;
  return has_cycles && text != nullptr && parse_utc(text, utc_s) ? utc_s : 0;
}

std::string duration_text(std::int64_t seconds) {
  if (seconds < 120) return std::to_string(seconds) + " s";
  if (seconds < 7'200) return std::to_string(seconds / 60) + " min";
  return std::to_string(seconds / 3'600) + " h";
}

std::vector<std::string> memories_of(const NotifySettings& settings) {
  std::vector<std::string> paths = {settings.memory};
  paths.insert(paths.end(), settings.memory_copies.begin(), settings.memory_copies.end());
  return paths;
}

NotifierState recall(const NotifySettings& settings) {
  NotifierStateReading reading = read_newest_notifier_state(memories_of(settings));
  for (const std::string& loss : reading.losses) say(JournalLevel::kError, loss);
  return std::move(reading.told);
}

/// Why what should have been published days ago is not there, in one line; empty: it is.
std::string settled_trouble(const std::string& file, std::int64_t now_utc_s) {
  constexpr std::int64_t kLateS = 3 * 86'400;  // a day is published on the next
  constexpr const char* kMend = ": bess-prices --settle says why";
  SettledPrices prices;
  const std::string loss = prices.read(file);
  if (!loss.empty()) return loss;
  if (prices.quarters().empty()) return std::string("no settled price has come yet") + kMend;
  const std::int64_t newest_utc_s = prices.quarters().back().start_utc_s;
  const std::int64_t midnight_utc_s = DayAccount(local_day_at(now_utc_s)).start_utc_s();
  if (midnight_utc_s - newest_utc_s <= kLateS) return "";
  return "no settled price is newer than " + std::string(utc_text(newest_utc_s).view()) + kMend;
}

}  // namespace

Notifier::Notifier(const NotifySettings& settings, MqttPresence presence)
    : settings_(settings),
      told_(recall(settings)),
      energy_(told_.energy),
      book_(settings.after_s, told_.alarms),
      desk_(settings.mqtt.hold_minutes, settings.power_w),
      kept_(notifier_state_text(told_)) {
  if (!settings_.command.empty()) {
    open_outbox("command", [this](const Message& message, const std::stop_token& stop) {
      return run_alarm_command(settings_, message, stop);
    });
  }
  if (!settings_.mqtt.host.empty()) open_mqtt(presence);
}

void Notifier::open_mqtt(MqttPresence presence) {
  const bool takes_orders = settings_.mqtt.orders && presence == MqttPresence::kStays;
  mqtt_ = std::make_unique<MqttClient>(settings_, presence, takes_orders ? &orders_ : nullptr);
  if (!settings_.mqtt.discovery_prefix.empty()) {
    mqtt_->retain(discovery_topic(settings_), discovery_json(settings_, BESS_VERSION));
  }
  open_outbox("mqtt", [this](const Message& message, const std::stop_token& stop) {
    if (!mqtt_->trouble().empty()) return mqtt_->trouble();
    return mqtt_->send(topic(settings_.name, "event"), message_json(settings_.name, message), stop);
  });
}

void Notifier::open_outbox(const char* name, Channel way) {
  outboxes_.try_emplace(name, name, std::move(way), std::move(told_.owed[name]), taken_);
}

Notifier::~Notifier() {
  constexpr std::chrono::seconds kGrace(2);
  static_cast<void>(wait_for_channels(kGrace));
  for (auto& [name, outbox] : outboxes_) outbox.stop();
  keep();
}

void Notifier::run_round(std::int64_t now_utc_s) {
  const ControllerStatus status = ask_controller(settings_.program, settings_.config_path);
  std::vector<Trouble> troubles = troubles_of(status);
  if (!memory_trouble_.empty()) troubles.push_back({.key = "memory", .text = memory_trouble_});
  look_at_settled(now_utc_s);
  if (!settled_trouble_.empty()) troubles.push_back({.key = "settled", .text = settled_trouble_});
  if (mqtt_ != nullptr && mqtt_->is_cut_off()) {
    troubles.push_back({.key = "mqtt_cut_off",
                        .text = "the MQTT broker ends each connection: is there another client "
                                "with the id of this one, from a copied machine?"});
  }
  tell_events(book_.observe(troubles, now_utc_s), now_utc_s);
  read_log(newest_utc_of(status), now_utc_s);
  publish(status);
  keep();  // before it is sent: killed in between, a message is sent late and not never
  for (auto& [name, outbox] : outboxes_) outbox.begin_round(now_utc_s);
}

void Notifier::look_at_settled(std::int64_t now_utc_s) {
  constexpr std::int64_t kEveryS = 3'600, kSoonS = 300;
  if (!settings_.awaits_settled || now_utc_s < settled_due_utc_s_) return;
  settled_trouble_ = settled_trouble(settings_.money.settled_file, now_utc_s);
  settled_due_utc_s_ = now_utc_s + (settled_trouble_.empty() ? kEveryS : kSoonS);
}

void Notifier::follow_orders() {
  bool has_changed = false;
  while (const std::optional<MqttOrder> asked = orders_.take()) {
    Order order = desk_.follow(*asked, is_held_);
    has_changed = true;
    if (order.words.empty()) {
      if (!order.complaint.empty()) say(JournalLevel::kWarning, "mqtt order: " + order.complaint);
      continue;
    }
    std::string said;
    for (const std::string& word : order.words) said += ' ' + word;
    order.words.insert(order.words.begin(), settings_.program);
    order.words.insert(order.words.end(), {"--config", settings_.config_path});
    const ProgramResult result = run_and_hear(order.words, kOrderS);
    say(result.is_well() ? JournalLevel::kNotice : JournalLevel::kWarning,
        "mqtt orders:" + said + ": " + (result.is_well() ? "done" : result.complaint()));
  }
  if (has_changed) publish(ask_controller(settings_.program, settings_.config_path));
}

bool Notifier::wait_for_channels(std::chrono::milliseconds patience) {
  using std::chrono::steady_clock;
  const auto deadline = steady_clock::now() + patience;
  const auto left = [&] {
    return duration_cast<std::chrono::milliseconds>(deadline - steady_clock::now());
  };
  bool are_done = true;
  for (const auto& [name, outbox] : outboxes_)
    are_done = outbox.wait_until_done(left()) && are_done;
  if (mqtt_ != nullptr) static_cast<void>(mqtt_->wait_until_retained(left()));
  keep();
  return are_done;
}

bool Notifier::send_test(std::int64_t now_utc_s) {
  bool all = true;
  for (const auto& [name, outbox] : outboxes_) {
    const std::string trouble = outbox.send_now({.kind = MessageKind::kTest,
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
  for (auto& [name, outbox] : outboxes_) outbox.add(message);
}

void Notifier::tell_events(const std::vector<AlarmEvent>& events, std::int64_t now_utc_s) {
  for (const auto& [is_over, alarm] : events) {
    Message message{.kind = is_over ? MessageKind::kOver : MessageKind::kAlarm,
                    .key = alarm.key,
                    .text = alarm.text,
                    .utc_s = now_utc_s,
                    .since_utc_s = alarm.since_utc_s};
    // It began up to a round before it was first seen, and ended up to a round after the last time.
    const std::int64_t lasted_s = alarm.seen_utc_s - alarm.since_utc_s + settings_.every_s;
    if (is_over) message.text += " (lasted " + duration_text(lasted_s) + ")";
    tell(message);
  }
}

/// Only behind a new cycle: to look for the newest record costs a reading of the whole log.
void Notifier::read_log(std::int64_t newest_utc_s, std::int64_t now_utc_s) {
  LogReader log;
  FileMessage ignored;
  EventLogSettings places;
  places.ring.assign(settings_.ring);
  places.run_ring.assign(settings_.run_ring);
  const bool is_new = newest_utc_s != 0 && newest_utc_s != read_up_to_utc_s_;
  if (!is_new || !log.open(places, ignored)) return;
  read_up_to_utc_s_ = newest_utc_s;
  energy_.count_new(log);
  const std::int32_t today = local_day_at(newest_utc_s);
  const std::vector<DayAccount> accounts = accounts_of_days(
      log, today, today, {.settled = {}, .capacity_wh = settings_.money.capacity_wh});
  today_ = accounts.empty() ? DayAccount(today) : accounts.front();
  if (settings_.daily) tell_days(log, newest_utc_s, now_utc_s);
}

/// By the controller's own time: its newest record begins the new day.
void Notifier::tell_days(const LogReader& log, std::int64_t newest_utc_s, std::int64_t now_utc_s) {
  const std::int32_t today = local_day_at(newest_utc_s);
  const std::int32_t yesterday = local_day_at(newest_utc_s - 86'400);
  if (told_.local_day == 0) told_.local_day = yesterday;     // the days before were not watched
  if (told_.local_day > today) told_.local_day = yesterday;  // told while the clock was wrong
  if (told_.local_day >= yesterday) return;
  std::string ignored;  // its fetcher tells it
  const MoneyTerms terms = money_terms(settings_.money, ignored);
  std::vector<DayAccount> days = accounts_of_days(log, told_.local_day + 1, yesterday, terms);
  if (days.size() > kDaysMax) days.erase(days.begin(), days.end() - kDaysMax);
  for (const DayAccount& day : days) {
    tell({.kind = MessageKind::kDay, .key = day.date(), .text = day.line(), .utc_s = now_utc_s});
    if (mqtt_ != nullptr) mqtt_->retain(topic(settings_.name, "day"), day_json(day));
  }
  told_.local_day = yesterday;
}

void Notifier::publish(const ControllerStatus& status) {
  if (mqtt_ == nullptr) return;
  is_held_ = status.json.value()["last"]["held"].boolean().value_or(false);
  const std::vector<Alarm>& alarms = book_.alarms();
  const auto told =
      std::count_if(alarms.begin(), alarms.end(), [](const Alarm& alarm) { return alarm.is_told; });
  mqtt_->retain(topic(settings_.name, "state"),
                state_json(status, static_cast<std::size_t>(told),
                           {energy_, today_, settings_.mqtt.orders ? &desk_ : nullptr}));
  mqtt_->retain(topic(settings_.name, "alarms"), alarms_json(alarms));
}

void Notifier::keep() {
  taken_.hush();
  told_.alarms = book_.alarms();
  told_.owed.clear();  // of ways that are not configured any more
  for (const auto& [name, outbox] : outboxes_) told_.owed[name] = outbox.owed();
  // Its growth can be counted again from the log: alone it is not worth a write to the card.
  const bool is_energy_due =
      energy_.counted_utc_s - told_.energy.counted_utc_s >= kKeepEnergyEveryS;
  if (!is_energy_due && notifier_state_text(told_) == kept_ && memory_trouble_.empty()) return;
  told_.energy = energy_;
  ++told_.number;
  const std::string text = notifier_state_text(told_);
  const std::string trouble_before =
      std::exchange(memory_trouble_, write_notifier_state(memories_of(settings_), text));
  if (trouble_before.empty() && !memory_trouble_.empty()) {
    say(JournalLevel::kWarning, memory_trouble_);
  } else if (!trouble_before.empty() && memory_trouble_.empty()) {
    say(JournalLevel::kNotice, settings_.memory + " is written again");
  }
  kept_ = text;
}

}  // namespace bess
