// A broker, reached in the background: libmosquitto's own thread connects again whenever it is
// lost. Retained values are published as they come and again after each connect; an event waits in
// libmosquitto's memory until the broker acknowledges it.
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

/// A visitor leaves neither `status` nor a will, and takes no name that the watching notifier has.
enum class MqttPresence { kStays, kVisits };

class MqttClient {
 public:
  /// Of an order's topic and payload, by libmosquitto's thread.
  using OnOrder = std::function<void(const std::string& topic, const std::string& payload)>;

  /// Nothing is sent yet; who stays leaves `status` as the last will. Without `on_order` nothing
  /// may be ordered.
  MqttClient(const NotifySettings& settings, MqttPresence presence, OnOrder on_order = {});
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;
  /// Says offline, and goes.
  ~MqttClient();

  /// Retained by the broker for later subscribers. Kept here as well, for the next connect.
  void retain(const std::string& topic, const std::string& payload);
  /// Not retained: delivered once, to current subscribers.
  void publish(const std::string& topic, const std::string& payload);
  /// Until the broker has all that was published; false when it has not within that time.
  bool wait_until_sent(std::chrono::milliseconds patience);

  bool is_connected();
  /// Connections keep ending soon after they begin: another client has this client id.
  bool is_cut_off();
  /// Empty when the broker has all that was published; else why it has it not. Waits five
  /// seconds at most.
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
