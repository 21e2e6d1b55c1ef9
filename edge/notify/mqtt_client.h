// A broker, reached in the background: libmosquitto's own thread connects again whenever it is lost. Retained
// values are published as they come and again after each connect.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "edge/notify/notify_settings.h"

struct mosquitto;

namespace bess {

class MqttClient {
 public:
  /// Leaves `status` as the last will. Nothing is sent yet.
  MqttClient(const MqttSettings& settings, const std::string& node);
  MqttClient(const MqttClient&) = delete;
  MqttClient& operator=(const MqttClient&) = delete;
  /// Says offline, and goes.
  ~MqttClient();

  /// Empty, or why the settings cannot be used at all.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }

  /// Held by the broker for whoever comes later. Kept here as well, for the next connect.
  void retain(const std::string& topic, const std::string& payload);
  /// Once; waits up to five seconds until the broker has it. Empty, or why it has it not.
  std::string send(const std::string& topic, const std::string& payload);

  // Called by libmosquitto's thread.
  void on_connect(int code);
  void on_disconnect();
  void on_published(int message_id);

 private:
  void set_up(const MqttSettings& settings);
  bool is_connected();

  mosquitto* client_ = nullptr;
  std::string status_topic_;
  std::string trouble_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_connected_ = false;
  int refusal_ = 0;              ///< the broker's answer to the last connect
  std::set<int> published_ids_;  ///< acknowledged since the last `send` began
  std::map<std::string, std::string> retained_;
};

}  // namespace bess
