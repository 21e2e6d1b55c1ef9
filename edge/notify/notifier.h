// One round of the notifier: ask, compare with what was told, tell the rest by every way.
//   bess-edge status, decision log --> AlarmBook, DayAccount --> messages --> mail, webhook, MQTT
// It reads files and asks a program; nothing here holds what the controller needs. What a way does not take
// is tried again every round, for three days.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "edge/notify/alarm_book.h"
#include "edge/notify/controller_status.h"
#include "edge/notify/message.h"
#include "edge/notify/mqtt_client.h"
#include "edge/notify/notify_settings.h"
#include "edge/notify/told.h"

namespace bess {

/// Empty when a message was taken; else why not.
using Way = std::function<std::string(const Message&)>;
using Ways = std::map<std::string, Way>;

class Notifier {
 public:
  /// Opens the ways that the settings name.
  explicit Notifier(const NotifySettings& settings);

  void run_round(std::int64_t now_utc_s);
  /// A message by every way, once. False when one did not take it.
  bool send_test(std::int64_t now_utc_s);

 private:
  void tell(const Message& message);
  void tell_events(const std::vector<AlarmEvent>& events, std::int64_t now_utc_s);
  void tell_days(const ControllerStatus& status, std::int64_t now_utc_s);
  void deliver(std::int64_t now_utc_s);
  void publish(const ControllerStatus& status);
  void keep();

  NotifySettings settings_;
  Told told_;
  AlarmBook book_;
  std::unique_ptr<MqttClient> mqtt_;
  Ways ways_;
  std::map<std::string, std::string> trouble_of_way_;  ///< said once, not every round
  bool is_memory_failing_ = false;
};

}  // namespace bess
