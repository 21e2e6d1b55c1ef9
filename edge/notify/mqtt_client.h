// A broker, reached in the background: libmosquitto's own thread connects again whenever it is
// lost. Retained values are published as they come and again after each connect.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>

#include "edge/notify/mqtt_orders.h"
#include "edge/notify/notify_settings.h"

struct mosquitto;

namespace bess {

/// A visitor leaves neither `status` nor a will, and takes no name that the watching notifier has.
enum class MqttPresence { kStays, kVisits };

class MqttClient {
 public:
  /// Nothing is sent yet; who stays leaves `status` as the last will. `orders` gets what may be
  /// ordered; null: nothing may.
  MqttClient(const NotifySettings& notify, MqttPresence presence, MqttOrderBox* orders = nullptr);
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;
  /// Says offline, and goes.
  ~MqttClient();

  /// Empty, or why the settings cannot be used at all.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// Connections keep ending soon after they begin: another client has this client id.
  [[nodiscard]] bool is_cut_off();

  /// Held by the broker for whoever comes later. Kept here as well, for the next connect.
  void retain(const std::string& topic, const std::string& payload);
  /// Until the broker has all that is retained; false when it has not within that time, nor within
  /// the settings'.
  bool wait_until_retained(std::chrono::milliseconds patience);
  /// Waits for a connection, then until the broker has it, each as long as the settings say. Empty,
  /// or why it has it not: then the next call with the same payload waits for this one, so that it
  /// comes once.
  std::string send(const std::string& topic, const std::string& payload,
                   const std::stop_token& stop);

  // Called by libmosquitto's thread.
  void on_connect(int code);
  void on_disconnect();
  void on_published(int message_id);
  void on_message(const std::string& topic, std::string payload, bool is_retained);

 private:
  /// What was handed to libmosquitto, which sends it again after each connect until it is
  /// acknowledged.
  struct OnItsWay {
    int id = -1;  ///< -1: nothing
    std::string payload{};
    bool is_acknowledged = false;
  };

  int leave_will();
  void set_up();
  std::string why_not_connected(const std::stop_token& stop);
  bool is_connected();
  [[nodiscard]] bool end_thread() const;
  void publish_retained(const std::string& topic, const std::string& payload);

  const MqttSettings settings_;
  const MqttPresence presence_;
  mosquitto* client_ = nullptr;
  MqttOrderBox* const orders_;
  std::string status_topic_;
  std::string order_topics_[2];
  std::string trouble_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool is_connected_ = false;
  int cut_off_ = 0;  ///< connections in a row that did not last
  std::chrono::steady_clock::time_point connected_{};
  int refusal_ = 0;  ///< the broker's answer to the last connect
  OnItsWay on_its_way_{};
  std::map<std::string, std::string> retained_;
  std::set<int> unacknowledged_;  ///< retained values of this connection
};

}  // namespace bess
