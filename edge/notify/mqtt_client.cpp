#include "edge/notify/mqtt_client.h"

#include <mosquitto.h>

#include <chrono>

#include "edge/notify/topics.h"

namespace bess {
namespace {

constexpr int kQos = 1;
constexpr int kKeepAliveS = 60;
constexpr std::chrono::seconds kWait(5);

const char* text_or_null(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

int publish(mosquitto* client, int* id, const std::string& topic, const std::string& payload,
            bool retained) {
  return mosquitto_publish(client, id, topic.c_str(), static_cast<int>(payload.size()),
                           payload.data(), kQos, retained);
}

}  // namespace

MqttClient::MqttClient(const MqttSettings& settings, const std::string& node)
    : status_topic_(topic(node, "status")) {
  mosquitto_lib_init();
  client_ = mosquitto_new(("bess-notify-" + node).c_str(), true, this);
  if (client_ == nullptr) {
    trouble_ = "mqtt: no memory";
    return;
  }
  set_up(settings);
}

void MqttClient::set_up(const MqttSettings& settings) {
  mosquitto_connect_callback_set(client_, [](mosquitto*, void* self, int code) {
    static_cast<MqttClient*>(self)->on_connect(code);
  });
  mosquitto_disconnect_callback_set(client_, [](mosquitto*, void* self, int) {
    static_cast<MqttClient*>(self)->on_disconnect();
  });
  mosquitto_publish_callback_set(client_, [](mosquitto*, void* self, int id) {
    static_cast<MqttClient*>(self)->on_published(id);
  });
  constexpr std::string_view kOffline = "offline";
  int code = mosquitto_will_set(client_, status_topic_.c_str(), kOffline.size(), kOffline.data(),
                                kQos, true);
  if (code == MOSQ_ERR_SUCCESS && !settings.user.empty()) {
    code =
        mosquitto_username_pw_set(client_, settings.user.c_str(), text_or_null(settings.password));
  }
  if (code == MOSQ_ERR_SUCCESS && !settings.ca_file.empty()) {
    code = mosquitto_tls_set(client_, settings.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr);
  }
  mosquitto_reconnect_delay_set(client_, 1, 60, true);
  // Begins without a broker, too: the thread tries again for ever.
  if (code == MOSQ_ERR_SUCCESS) code = mosquitto_loop_start(client_);
  if (code != MOSQ_ERR_SUCCESS) {
    trouble_ = std::string("mqtt: ") + mosquitto_strerror(code);
    return;
  }
  static_cast<void>(
      mosquitto_connect_async(client_, settings.host.c_str(), settings.port, kKeepAliveS));
}

MqttClient::~MqttClient() {
  if (client_ != nullptr) {
    if (is_connected()) static_cast<void>(send(status_topic_, "offline"));
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, false);
    mosquitto_destroy(client_);
  }
  mosquitto_lib_cleanup();
}

void MqttClient::retain(const std::string& topic, const std::string& payload) {
  const std::lock_guard lock(mutex_);
  retained_[topic] = payload;
  if (is_connected_) publish(client_, nullptr, topic, payload, true);
}

std::string MqttClient::send(const std::string& topic, const std::string& payload) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, kWait, [&] { return is_connected_; })) {
    return std::string("mqtt: no connection to the broker") +
           (refusal_ == 0 ? "" : std::string(": ") + mosquitto_connack_string(refusal_));
  }
  int id = 0;
  published_ids_.clear();
  const bool retained = topic == status_topic_;
  const int code = publish(client_, &id, topic, payload, retained);
  if (code != MOSQ_ERR_SUCCESS) return std::string("mqtt: ") + mosquitto_strerror(code);
  const bool has_it = changed_.wait_for(lock, kWait, [&] { return published_ids_.contains(id); });
  return has_it ? "" : "mqtt: the broker does not acknowledge";
}

bool MqttClient::is_connected() {
  const std::lock_guard lock(mutex_);
  return is_connected_;
}

void MqttClient::on_connect(int code) {
  const std::lock_guard lock(mutex_);
  refusal_ = code;
  is_connected_ = code == 0;
  if (is_connected_) {
    publish(client_, nullptr, status_topic_, "online", true);
    for (const auto& [topic, payload] : retained_) publish(client_, nullptr, topic, payload, true);
  }
  changed_.notify_all();
}

void MqttClient::on_disconnect() {
  const std::lock_guard lock(mutex_);
  is_connected_ = false;
}

void MqttClient::on_published(int message_id) {
  const std::lock_guard lock(mutex_);
  published_ids_.insert(message_id);
  changed_.notify_all();
}

}  // namespace bess
