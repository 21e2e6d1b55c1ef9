// One round of the notifier: ask bess-edge, compare with what was reported, report the rest.
//   bess-edge status -> troubles -> alarms -> messages -> queue -> command
//   bess-edge earned -> yesterday          -> messages -> MQTT event
//   both                                   -> MQTT state, alarms, day
// It reads and asks; nothing here holds what the controller needs. The command runs beside the
// rounds, one message at a time; what it does not take is kept, and tried again every round.
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

  /// Once `stop` is requested nothing here waits for long any more.
  explicit Notifier(const NotifySettings& settings, std::stop_token stop = {});
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  /// Lets the command end what it is at, for two seconds; what is cut then is reported after the
  /// next start.
  ~Notifier();

  void run_round(std::int64_t now_utc_s);
  /// Until that time or the stop, follows what the broker orders and hears of the command.
  void serve_until(TimePoint until) { serve(until, stop_, false); }
  /// Until the command has taken what is pending, or has failed, and a broker that is there has the
  /// newest values. False when the command is still at it after that time.
  bool finish(std::chrono::milliseconds patience);

 private:
  struct Order {
    std::string topic;
    std::string payload;
  };

  void serve(TimePoint until, const std::stop_token& stop, bool is_for_command);
  void tell(const Message& message);
  void tell_alarms(const ControllerStatus& status, std::int64_t now_utc_s);
  void tell_day(const ControllerStatus& status, std::int64_t now_utc_s);
  void note_connection();
  void publish(const ControllerStatus& status);
  void follow(const Order& order);
  void keep();
  void run_command();
  void hear_of_command(const std::string& trouble);

  const NotifySettings settings_;
  const std::stop_token stop_;
  NotifierState state_;
  std::string kept_;               ///< the text of it that was written last
  std::string memory_trouble_;     ///< why what is reported cannot be kept; empty = it is
  Json today_ = Json::object();    ///< as bess-edge earned has it
  std::string newest_utc_;         ///< of the cycle behind which it was asked
  bool is_held_ = false;           ///< by the newest status
  std::int32_t hold_power_w_ = 0;  ///< of the next hold that is ordered
  int rounds_apart_ = 0;           ///< in a row, without a connection to the broker
  bool is_command_running_ = false;
  std::string command_trouble_;  ///< logged once, not every round

  std::mutex mutex_;  ///< of what other threads leave for `serve`
  std::condition_variable_any changed_;
  std::deque<Order> orders_;
  std::optional<std::string> outcome_;  ///< of the command

  std::unique_ptr<MqttClient> mqtt_;  ///< null: no broker is configured
  std::jthread command_;
};

/// A message to each channel, past the queue. False when one did not take it.
bool send_test(const NotifySettings& settings, std::int64_t now_utc_s);

}  // namespace bess
