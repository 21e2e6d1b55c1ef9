#include "edge/companions/notify/notifier.h"

#include <cstdlib>
#include <utility>

#include "edge/companions/notify/topics.h"
#include "edge/records/log/journal.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"

namespace bess {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

void say(JournalLevel level, const std::string& text) {
  write_journal_line(level, "bess-notify: " + text);
}

std::string duration_text(std::int64_t seconds) {
  if (seconds < 120) return std::to_string(seconds) + " s";
  if (seconds < 7'200) return std::to_string(seconds / 60) + " min";
  return std::to_string(seconds / 3'600) + " h";
}

NotifierState recall(const NotifySettings& settings) {
  std::vector<std::string> losses;
  NotifierState state = read_notifier_state(settings.memories, losses);
  for (const std::string& loss : losses) say(JournalLevel::kError, loss);
  return state;
}

}  // namespace

Notifier::Notifier(const NotifySettings& settings, std::stop_token stop)
    : settings_(settings),
      stop_(std::move(stop)),
      state_(recall(settings)),
      kept_(notifier_state_text(state_)) {
  if (!settings_.has_channel()) {
    say(JournalLevel::kWarning,
        "[notify] names no channel: set command or mqtt_host; alerts go only to the journal");
  }
  say(JournalLevel::kNotice, "started");
  if (settings_.mqtt.host.empty()) return;
  const auto take_order = [this](const std::string& topic, const std::string& payload) {
    constexpr std::size_t kOrdersMax = 8;
    const std::lock_guard lock(mutex_);
    if (orders_.size() < kOrdersMax) orders_.push_back({topic, payload.substr(0, 64)});
    changed_.notify_all();
  };
  mqtt_ = std::make_unique<MqttClient>(
      settings_, MqttPresence::kStays,
      settings_.mqtt.orders ? MqttClient::OnOrder(take_order) : MqttClient::OnOrder());
  mqtt_->retain(discovery_topic(settings_), discovery_json(settings_, BESS_VERSION));
}

Notifier::~Notifier() {
  constexpr std::chrono::seconds kGrace(2);
  serve(steady_clock::now() + kGrace, {}, true);
  keep();
  say(JournalLevel::kNotice, "stopped");
}

void Notifier::run_round(std::int64_t now_utc_s) {
  const ControllerStatus status = ask_controller(settings_);
  notify_of_alerts(status, now_utc_s);
  notify_of_day(status, now_utc_s);
  if (mqtt_ != nullptr) note_connection();
  publish(status);
  keep();  // before sending: a kill in between delays a message but does not lose it
  run_command();
}

bool Notifier::finish(milliseconds patience) {
  serve(steady_clock::now() + patience, stop_, true);
  if (mqtt_ != nullptr) mqtt_->wait_until_sent(milliseconds(settings_.mqtt.wait_ms_max));
  return !is_command_running_;
}

void Notifier::serve(TimePoint until, const std::stop_token& stop, bool is_for_command) {
  std::unique_lock lock(mutex_);
  const auto has_news = [this] { return !orders_.empty() || outcome_.has_value(); };
  while ((is_command_running_ || !is_for_command) &&
         changed_.wait_until(lock, stop, until, has_news)) {
    const std::deque<Order> orders = std::exchange(orders_, {});
    const std::optional<std::string> outcome = std::exchange(outcome_, std::nullopt);
    lock.unlock();
    if (outcome.has_value()) note_command_result(*outcome);
    for (const Order& order : orders) follow(order);
    if (!orders.empty()) publish(ask_controller(settings_));
    lock.lock();
  }
}

void Notifier::notify_of_alerts(const ControllerStatus& status, std::int64_t now_utc_s) {
  std::vector<SeenAlert> seen = seen_alerts(status);
  if (!memory_trouble_.empty()) seen.push_back(seen_alert(Alert::kNotifyState, memory_trouble_));
  if (!settings_.settled_file.empty()) {
    const std::string trouble = settled_trouble(settings_.settled_file, now_utc_s);
    if (!trouble.empty()) seen.push_back(seen_alert(Alert::kSettledPrices, trouble));
  }
  if (mqtt_ != nullptr && mqtt_->is_cut_off()) {
    seen.push_back(seen_alert(Alert::kMqttCutOff));
  }
  for (const auto& [is_over, alert] : observe(state_.alerts, seen, settings_.after_s, now_utc_s)) {
    Message message{.severity = is_over ? "over" : "alarm",
                    .key = alert.key,
                    .text = alert.text,
                    .utc_s = now_utc_s,
                    .since_utc_s = alert.since_utc_s};
    // It began up to one round before it was first seen and ended up to one round after the last.
    const std::int64_t lasted_s = alert.seen_utc_s - alert.since_utc_s + settings_.every_s;
    if (is_over) message.text += " (lasted " + duration_text(lasted_s) + ")";
    send_message(message);
  }
}

/// Only after a new control cycle, because each answer reads the log. A day is complete with the
/// first control cycle of the next day; days before the start are not reported.
void Notifier::notify_of_day(const ControllerStatus& status, std::int64_t now_utc_s) {
  const std::string newest_utc = status.json.value()["last"]["utc"].text_or("");
  if (newest_utc.empty() || newest_utc == newest_utc_) return;
  newest_utc_ = newest_utc;
  Json today = ask_earned(settings_, {"today"});
  const std::string date = (*today.value()["days"].begin())["date"].text_or("");
  if (date.empty()) return;
  today_ = std::move(today);
  const std::string before = std::exchange(state_.day, date);
  if (before.empty() || before == date || !settings_.daily) return;
  const Json yesterday = ask_earned(settings_, {"yesterday"});
  const JsonValue day = *yesterday.value()["days"].begin();
  if (!day.exists()) return;
  send_message({.severity = "day",
                .key = day["date"].text_or(""),
                .text = day["line"].text_or(""),
                .utc_s = now_utc_s});
  if (mqtt_ != nullptr) mqtt_->retain(topic(settings_.name, "day"), day_json(yesterday.value()));
}

void Notifier::send_message(const Message& message) {
  say(message.severity == "alarm" ? JournalLevel::kWarning : JournalLevel::kNotice,
      headline(message));
  if (mqtt_ != nullptr) {
    mqtt_->publish(topic(settings_.name, "event"), event_json(settings_.name, message).line());
  }
  if (settings_.command.empty()) return;
  state_.pending.push_back(message);
  if (state_.pending.size() <= kPendingMax) return;
  const auto oldest = state_.pending.begin() + (is_command_running_ ? 1 : 0);
  say(JournalLevel::kError, "retry queue full; dropped: " + headline(*oldest));
  state_.pending.erase(oldest);
}

/// Logs each loss of the connection once.
void Notifier::note_connection() {
  constexpr int kRounds = 2;  // a short loss is not reported
  rounds_apart_ = mqtt_->is_connected() ? 0 : rounds_apart_ + 1;
  if (rounds_apart_ != kRounds) return;
  say(JournalLevel::kWarning, "mqtt: " + mqtt_->find_trouble() + "; retrying");
}

void Notifier::publish(const ControllerStatus& status) {
  if (mqtt_ == nullptr) return;
  const JsonValue last = status.json.value()["last"];
  is_held_ = last["held"].boolean().value_or(false);
  held_power_w_ =
      is_held_ ? static_cast<std::int32_t>(last["hold_power_w"].number().value_or(0)) : 0;
  mqtt_->retain(
      topic(settings_.name, "state"),
      state_json(status, state_.alerts, today_.value(),
                 settings_.mqtt.orders ? std::optional(next_hold_power_w()) : std::nullopt));
  mqtt_->retain(topic(settings_.name, "alarms"), alerts_json(state_.alerts));
}

/// Runs bess-edge hold, with its checks, and logs the result.
void Notifier::follow(const Order& order) {
  std::vector<std::string> words = {settings_.program, "hold"};
  if (order.topic.ends_with(kHoldPowerTopic)) {
    std::int32_t power_w = 0;
    if (!read_number(order.payload, power_w) || std::abs(power_w) > settings_.power_w) {
      return say(JournalLevel::kWarning,
                 "mqtt order refused: hold_power/set must be whole W, at most [battery] power_w");
    }
    hold_power_w_ = power_w;
    if (!is_held_) return;
  } else if (order.payload != "ON" && order.payload != "OFF") {
    return say(JournalLevel::kWarning, "mqtt order refused: hold/set must be ON or OFF");
  }
  if (order.payload == "OFF") {
    words.emplace_back("--release");
  } else {
    words.insert(words.end(), {std::to_string(next_hold_power_w()), "--for", "60m"});
  }
  words.insert(words.end(), {"--config", settings_.config_path});
  constexpr std::int64_t kOrderSMax = 10;
  const ProgramResult result = run_and_capture(words, kOrderSMax);
  say(result.is_well() ? JournalLevel::kNotice : JournalLevel::kWarning,
      "mqtt order: hold " + words[2] + ": " + (result.is_well() ? "done" : result.complaint()));
}

void Notifier::keep() {
  if (notifier_state_text(state_) == kept_ && memory_trouble_.empty()) return;
  ++state_.number;
  kept_ = notifier_state_text(state_);
  const std::string before =
      std::exchange(memory_trouble_, write_notifier_state(settings_.memories, kept_));
  if (before.empty() == memory_trouble_.empty()) return;
  say(JournalLevel::kWarning,
      memory_trouble_.empty() ? "notifier state stored again" : memory_trouble_);
}

/// Starts the command for the oldest message, unless it is running.
void Notifier::run_command() {
  if (is_command_running_ || state_.pending.empty()) return;
  is_command_running_ = true;
  command_ = std::jthread([this, message = state_.pending.front()](const std::stop_token& stop) {
    std::string trouble = run_alert_command(settings_, message, stop);
    const std::lock_guard lock(mutex_);
    outcome_ = std::move(trouble);
    changed_.notify_all();
  });
}

/// After a failure the queue waits for the next round.
void Notifier::note_command_result(const std::string& trouble) {
  is_command_running_ = false;
  const bool is_new = std::exchange(command_trouble_, trouble) != trouble;
  if (!trouble.empty()) {
    if (is_new) say(JournalLevel::kWarning, trouble + "; retrying every round");
    return;
  }
  state_.pending.pop_front();
  keep();
  run_command();
}

bool send_test(const NotifySettings& settings, std::int64_t now_utc_s) {
  bool all = true;
  Message message{.key = "test", .utc_s = now_utc_s};
  const auto note = [&all](const std::string& channel, const std::string& trouble) {
    all = all && trouble.empty();
    say(trouble.empty() ? JournalLevel::kInfo : JournalLevel::kError,
        trouble.empty() ? channel + ": sent" : trouble);
  };
  if (!settings.command.empty()) {
    message.text = "bess-notify can reach you by command";
    note("command", run_alert_command(settings, message));
  }
  if (!settings.mqtt.host.empty()) {
    message.text = "bess-notify can reach you by mqtt";
    MqttClient client(settings, MqttPresence::kVisits);
    client.publish(topic(settings.name, "event"), event_json(settings.name, message).line());
    const bool is_sent = client.wait_until_sent(milliseconds(2 * settings.mqtt.wait_ms_max));
    note("mqtt", is_sent ? "" : "mqtt: " + client.find_trouble());
  }
  return all;
}

}  // namespace bess
