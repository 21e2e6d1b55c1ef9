#include "edge/notify/mqtt_client.h"

#include <mosquitto.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "edge/notify/connection_trouble.h"
#include "edge/notify/topics.h"

namespace bess {
namespace {

constexpr int kQos = 1;
constexpr int kKeepAliveS = 60;
constexpr unsigned kReconnectSMax = 5;
constexpr std::string_view kOffline = "offline";

const char* text_or_null(const std::string& text) { return text.empty() ? nullptr : text.c_str(); }

/// A broker cuts off who has the same client id as a newcomer.
std::string client_name(const std::string& id, MqttPresence presence) {
  const std::string name = "bess-notify-" + id;
  return presence == MqttPresence::kStays ? name : name + "-" + std::to_string(getpid());
}

int publish(mosquitto* client, int* id, const std::string& topic, const std::string& payload,
            bool retained) {
  return mosquitto_publish(client, id, topic.c_str(), static_cast<int>(payload.size()),
                           payload.data(), kQos, retained);
}

}  // namespace

MqttClient::MqttClient(const NotifySettings& notify, MqttPresence presence, MqttOrderBox* orders)
    : settings_(notify.mqtt),
      presence_(presence),
      orders_(orders),
      status_topic_(topic(notify.name, "status")),
      order_topics_{topic(notify.name, kHoldTopic), topic(notify.name, kHoldPowerTopic)} {
  mosquitto_lib_init();
  client_ = mosquitto_new(client_name(notify.id, presence).c_str(), true, this);
  if (client_ == nullptr) {
    trouble_ = "mqtt: no memory";
    return;
  }
  set_up();
}

int MqttClient::leave_will() {
  if (presence_ == MqttPresence::kVisits) return MOSQ_ERR_SUCCESS;
  return mosquitto_will_set(client_, status_topic_.c_str(), kOffline.size(), kOffline.data(), kQos,
                            true);
}

void MqttClient::set_up() {
  mosquitto_connect_callback_set(client_, [](mosquitto*, void* self, int code) {
    static_cast<MqttClient*>(self)->on_connect(code);
  });
  mosquitto_disconnect_callback_set(client_, [](mosquitto*, void* self, int) {
    static_cast<MqttClient*>(self)->on_disconnect();
  });
  mosquitto_publish_callback_set(client_, [](mosquitto*, void* self, int id) {
    static_cast<MqttClient*>(self)->on_published(id);
  });
  if (orders_ != nullptr) {
    mosquitto_message_callback_set(client_,
                                   [](mosquitto*, void* self, const mosquitto_message* message) {
                                     static_cast<MqttClient*>(self)->on_message(
                                         message->topic,
                                         std::string(static_cast<const char*>(message->payload),
                                                     static_cast<std::size_t>(message->payloadlen)),
                                         message->retain);
                                   });
  }
  int code = leave_will();
  if (code == MOSQ_ERR_SUCCESS && !settings_.user.empty()) {
    code = mosquitto_username_pw_set(client_, settings_.user.c_str(),
                                     text_or_null(settings_.password));
  }
  if (code == MOSQ_ERR_SUCCESS && !settings_.ca_file.empty()) {
    code =
        mosquitto_tls_set(client_, settings_.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr);
  }
  mosquitto_reconnect_delay_set(client_, 1, kReconnectSMax, true);
  // Begins without a broker, too: the thread tries again for ever.
  if (code == MOSQ_ERR_SUCCESS) code = mosquitto_loop_start(client_);
  if (code != MOSQ_ERR_SUCCESS) {
    trouble_ = std::string("mqtt: ") + mosquitto_strerror(code);
    return;
  }
  static_cast<void>(
      mosquitto_connect_async(client_, settings_.host.c_str(), settings_.port, kKeepAliveS));
}

MqttClient::~MqttClient() {
  if (client_ == nullptr) return;
  if (is_connected() && presence_ == MqttPresence::kStays) {
    static_cast<void>(send(status_topic_, std::string(kOffline), {}));
  }
  mosquitto_disconnect(client_);
  if (end_thread()) {
    mosquitto_destroy(client_);
    mosquitto_lib_cleanup();
    return;
  }
  // It sits in a connect, or a look-up, of minutes: cut there it would keep the library's locks. It
  // ends with the process, and calls nobody any more.
  mosquitto_connect_callback_set(client_, nullptr);
  mosquitto_disconnect_callback_set(client_, nullptr);
  mosquitto_publish_callback_set(client_, nullptr);
  mosquitto_message_callback_set(client_, nullptr);
}

/// False when libmosquitto's thread does not end within twice the pause between two connects.
bool MqttClient::end_thread() const {
  struct Ended {
    std::mutex mutex;
    std::condition_variable changed;
    bool is_true = false;
  };
  const auto ended = std::make_shared<Ended>();
  std::thread([client = client_, ended] {
    mosquitto_loop_stop(client, false);
    const std::lock_guard lock(ended->mutex);
    ended->is_true = true;
    ended->changed.notify_all();
  }).detach();
  constexpr std::chrono::seconds kPatience(2 * kReconnectSMax);
  std::unique_lock lock(ended->mutex);
  return ended->changed.wait_for(lock, kPatience, [&] { return ended->is_true; });
}

void MqttClient::retain(const std::string& topic, const std::string& payload) {
  const std::lock_guard lock(mutex_);
  retained_[topic] = payload;
  if (is_connected_) publish_retained(topic, payload);
}

void MqttClient::publish_retained(const std::string& topic, const std::string& payload) {
  int id = 0;
  const int code = publish(client_, &id, topic, payload, true);
  if (code == MOSQ_ERR_SUCCESS) unacknowledged_.insert(id);
}

bool MqttClient::wait_until_retained(std::chrono::milliseconds patience) {
  const std::chrono::milliseconds patience_max(settings_.wait_ms_max);
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, std::min(patience, patience_max),
                           [&] { return is_connected_ && unacknowledged_.empty(); });
}

std::string MqttClient::send(const std::string& topic, const std::string& payload,
                             const std::stop_token& stop) {
  const std::chrono::milliseconds patience(settings_.wait_ms_max);
  std::unique_lock lock(mutex_);
  if (!changed_.wait_for(lock, stop, patience, [&] { return is_connected_; })) {
    lock.unlock();
    return "mqtt: no connection to the broker: " + why_not_connected(stop);
  }
  if (on_its_way_.id < 0 || on_its_way_.payload != payload) {
    on_its_way_ = {.payload = payload};
    const bool retained = topic == status_topic_;
    const int code = publish(client_, &on_its_way_.id, topic, payload, retained);
    if (code != MOSQ_ERR_SUCCESS) {
      on_its_way_ = {};
      return std::string("mqtt: ") + mosquitto_strerror(code);
    }
  }
  if (!changed_.wait_for(lock, stop, patience, [&] { return on_its_way_.is_acknowledged; })) {
    return "mqtt: the broker does not acknowledge: is it overloaded, is the line bad?";
  }
  on_its_way_ = {};
  return "";
}

std::string MqttClient::why_not_connected(const std::stop_token& stop) {
  const std::string trouble =
      probe_connection({settings_.host, settings_.port, settings_.ca_file},
                       "mqtt_ca_file must hold the one that signed it", stop);
  if (!trouble.empty()) return trouble;
  const std::lock_guard lock(mutex_);
  if (refusal_ != 0) {
    return std::string(mosquitto_connack_string(refusal_)) +
           " see mqtt_user, mqtt_password_file and the broker's log";
  }
  return "it can be reached, but does not let us in: does it speak MQTT there?";
}

bool MqttClient::is_connected() {
  const std::lock_guard lock(mutex_);
  return is_connected_;
}

void MqttClient::on_connect(int code) {
  const std::lock_guard lock(mutex_);
  refusal_ = code;
  is_connected_ = code == 0;
  connected_ = std::chrono::steady_clock::now();
  if (is_connected_ && presence_ == MqttPresence::kStays) {
    unacknowledged_.clear();
    publish_retained(status_topic_, "online");
    for (const auto& [topic, payload] : retained_) publish_retained(topic, payload);
    if (orders_ != nullptr) {
      for (const std::string& topic : order_topics_) {
        static_cast<void>(mosquitto_subscribe(client_, nullptr, topic.c_str(), kQos));
      }
    }
  }
  changed_.notify_all();
}

void MqttClient::on_disconnect() {
  const std::lock_guard lock(mutex_);
  constexpr std::chrono::seconds kLasts(30);
  const bool has_lasted = std::chrono::steady_clock::now() - connected_ >= kLasts;
  if (is_connected_) cut_off_ = has_lasted ? 0 : cut_off_ + 1;
  is_connected_ = false;
}

bool MqttClient::is_cut_off() {
  constexpr int kInARow = 5;
  const std::lock_guard lock(mutex_);
  return cut_off_ >= kInARow;
}

void MqttClient::on_message(const std::string& topic, std::string payload, bool is_retained) {
  if (is_retained) return;  // given when nobody was here: not meant for now
  if (topic == order_topics_[0]) orders_->add({kHoldTopic, std::move(payload)});
  if (topic == order_topics_[1]) orders_->add({kHoldPowerTopic, std::move(payload)});
}

void MqttClient::on_published(int message_id) {
  const std::lock_guard lock(mutex_);
  unacknowledged_.erase(message_id);
  if (message_id == on_its_way_.id) on_its_way_.is_acknowledged = true;
  changed_.notify_all();
}

}  // namespace bess
