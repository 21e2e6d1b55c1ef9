// One round of the notifier: ask, compare with what was told, hand the rest to every way's outbox.
//   bess-edge status, decision log -> AlarmBook, DayAccount -> messages
//   messages -> outboxes: command, MQTT
// It reads files and asks a program; nothing here holds what the controller needs. A round waits
// for no way: what a way does not take is tried again every round, for three days, from its own
// outbox.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "edge/account/day_account.h"
#include "edge/log/log_reader.h"
#include "edge/notify/alarm_book.h"
#include "edge/notify/bell.h"
#include "edge/notify/controller_status.h"
#include "edge/notify/energy_totals.h"
#include "edge/notify/message.h"
#include "edge/notify/mqtt_client.h"
#include "edge/notify/mqtt_orders.h"
#include "edge/notify/notifier_state.h"
#include "edge/notify/notify_settings.h"
#include "edge/notify/outbox.h"

namespace bess {

class Notifier {
 public:
  /// Opens the ways that the settings name.
  Notifier(const NotifySettings& settings, MqttPresence presence = MqttPresence::kStays);
  Notifier(const Notifier&) = delete;
  Notifier& operator=(const Notifier&) = delete;
  /// Lets the ways end what they are at, for two seconds; what is cut then is told after the next
  /// start.
  ~Notifier();

  void run_round(std::int64_t now_utc_s);
  /// Carries out what the broker has ordered since, and publishes what came of it.
  void follow_orders();
  /// Readable when a way has taken something, or an order has come: `follow_orders` and `keep` are
  /// due.
  [[nodiscard]] int bell() const { return taken_.fd(); }
  /// Writes down what was told and what is owed, where that has changed.
  void keep();
  /// Until every way has taken what is owed, or has failed, and a broker that is there has the
  /// newest values; then keeps it. False when the patience ends before.
  bool wait_for_channels(std::chrono::milliseconds patience);
  /// A message by every way, once. False when one did not take it.
  bool send_test(std::int64_t now_utc_s);

 private:
  void open_mqtt(MqttPresence presence);
  void open_outbox(const char* name, Channel way);
  void tell(const Message& message);
  void tell_events(const std::vector<AlarmEvent>& events, std::int64_t now_utc_s);
  void read_log(std::int64_t newest_utc_s, std::int64_t now_utc_s);
  void tell_days(const LogReader& log, std::int64_t newest_utc_s, std::int64_t now_utc_s);
  void publish(const ControllerStatus& status);
  /// Once an hour: the file is long.
  void look_at_settled(std::int64_t now_utc_s);

  const NotifySettings settings_;
  NotifierState told_;  ///< as it was kept last
  EnergyTotals energy_;
  DayAccount today_{0};                ///< of the newest record
  std::int64_t read_up_to_utc_s_ = 0;  ///< the cycle behind which the log was read last
  AlarmBook book_;
  Bell taken_;
  MqttOrderBox orders_{taken_};
  HoldDesk desk_;
  bool is_held_ = false;  ///< by the newest status
  std::unique_ptr<MqttClient> mqtt_;
  std::map<std::string, Outbox> outboxes_;  ///< after what their threads use
  std::string kept_;                        ///< the text that was written last
  std::string settled_trouble_;  ///< why nobody knows what is billed; empty = it is known
  std::int64_t settled_due_utc_s_ = 0;
  std::string memory_trouble_;  ///< why what is told cannot be kept; empty = it is
};

}  // namespace bess
