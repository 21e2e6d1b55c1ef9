// Notifier round: reads bess-edge status and reports changes.
//   bess-edge status -> seen alerts -> told alerts -> messages -> retry queue -> command
//   bess-edge earned -> yesterday          -> messages -> MQTT event
//   both                                   -> MQTT state, alarms, day
// Takes nothing that the controller needs. The command runs in its own thread, one message at a
// time; the retry queue keeps undelivered messages for the next round.
#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "edge/companions/notify/controller_status.h"
#include "edge/companions/notify/mqtt_client.h"
#include "edge/companions/notify/notifier_state.h"
#include "edge/companions/notify/notify_settings.h"

namespace bess {

class Notifier {
 public:
  static constexpr std::size_t kPendingMax = 200;
  using TimePoint = std::chrono::steady_clock::time_point;

  /// After a stop request no call here waits long.
  explicit Notifier(const NotifySettings& settings, std::stop_token stop = {});
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  /// Waits up to 2 s for the running command; an interrupted message is sent after the next start.
  ~Notifier();

  void run_round(std::int64_t now_utc_s);
  /// Until that time or a stop request, handles orders of the broker and results of the command.
  void serve_until(TimePoint until) { serve(until, stop_, false); }
  /// Waits until the command has delivered the queue or failed, and a connected broker has the
  /// newest values. False when the command is still running after that time.
  bool finish(std::chrono::milliseconds patience);

 private:
  struct Order {
    std::string topic;
    std::string payload;
  };

  void serve(TimePoint until, const std::stop_token& stop, bool is_for_command);
  void send_message(const Message& message);
  void notify_of_alerts(const ControllerStatus& status, std::int64_t now_utc_s);
  void notify_of_day(const ControllerStatus& status, std::int64_t now_utc_s);
  void note_connection();
  void publish(const ControllerStatus& status);
  void follow(const Order& order);
  void keep();
  void run_command();
  void note_command_result(const std::string& trouble);
  [[nodiscard]] std::int32_t next_hold_power_w() const {
    return hold_power_w_.value_or(held_power_w_);
  }

  const NotifySettings settings_;
  const std::stop_token stop_;
  NotifierState state_;
  std::string kept_;                          ///< state text written last
  std::string memory_trouble_;                ///< why the state cannot be stored, or empty
  Json today_ = Json::object();               ///< from bess-edge earned
  std::string newest_utc_;                    ///< control cycle of the last `earned` query
  bool is_held_ = false;                      ///< in the newest status
  std::optional<std::int32_t> hold_power_w_;  ///< ordered since the start, for the next hold
  std::int32_t held_power_w_ = 0;             ///< of the hold in force; 0 = none
  int rounds_apart_ = 0;  ///< rounds in a row without a connection to the broker
  bool is_command_running_ = false;
  std::string command_trouble_;  ///< logged once, not every round

  std::mutex mutex_;  ///< for data that other threads pass to `serve`
  std::condition_variable_any changed_;
  std::deque<Order> orders_;
  std::optional<std::string> outcome_;  ///< of the command

  std::unique_ptr<MqttClient> mqtt_;  ///< null: no broker configured
  std::jthread command_;
};

/// Sends a message to each channel, bypassing the queue. False when one failed.
bool send_test(const NotifySettings& settings, std::int64_t now_utc_s);

}  // namespace bess
