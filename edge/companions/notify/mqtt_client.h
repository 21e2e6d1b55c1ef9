// MQTT client in the background: the thread of libmosquitto reconnects after each loss. Retained
// values are published immediately and again after each connect; an event stays in the memory of
// libmosquitto until the broker acknowledges it.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "edge/companions/notify/notify_settings.h"

struct mosquitto;

namespace bess {

/// kVisits: no `status` topic, no last will, and another client id than the running notifier.
enum class MqttPresence { kStays, kVisits };

class MqttClient {
 public:
  /// Called with topic and payload of an order, by the thread of libmosquitto.
  using OnOrder = std::function<void(const std::string& topic, const std::string& payload)>;

  /// Sends nothing yet; kStays sets `status` as the last will. Without `on_order`, no orders.
  MqttClient(const NotifySettings& settings, MqttPresence presence, OnOrder on_order = {});
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;
  /// Publishes "offline" and disconnects.
  ~MqttClient();

  /// Retained by the broker for later subscribers, and here for the next connect.
  void retain(const std::string& topic, const std::string& payload);
  /// Not retained: delivered once, to current subscribers.
  void publish(const std::string& topic, const std::string& payload);
  /// Waits until the broker has acknowledged all messages; false after `patience`.
  bool wait_until_sent(std::chrono::milliseconds patience);

  bool is_connected();
  /// True when connections repeatedly end early: another client has this client id.
  bool is_cut_off();
  /// Why the broker has not acknowledged all messages, or empty. Waits at most 5 s.
  std::string find_trouble();

 private:
  void on_connect(int code);
  void on_disconnect();
  void on_published(int message_id);
  void send(const std::string& topic, const std::string& payload, bool is_retained);

  const MqttSettings settings_;
  const MqttPresence presence_;
  const OnOrder on_order_;
  const std::string status_topic_;
  const std::string order_topics_[2];
  mosquitto* client_ = nullptr;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_connected_ = false;
  int cut_off_ = 0;  ///< connections in a row that did not last
  std::chrono::steady_clock::time_point connected_{};
  int refusal_ = 0;  ///< the broker's answer to the last connect
  std::map<std::string, std::string> retained_;
  std::set<int> unacknowledged_;
};

}  // namespace bess
