#include "edge/companions/notify/mqtt_client.h"

#include <curl/curl.h>
#include <mosquitto.h>
#include <unistd.h>

#include <new>
#include <thread>

#include "edge/companions/notify/topics.h"
#include "shared/host/http_client.h"

namespace bess {
namespace {

constexpr int kQos = 1;
constexpr int kKeepAliveS = 60;
constexpr unsigned kReconnectSMax = 5;
constexpr std::string_view kOffline = "offline";

/// Connects and disconnects; empty when host, port and certificate are correct.
std::string probe_connection(const MqttSettings& broker) {
  constexpr long kProbeMsMax = 5'000;
  CURL* const curl = curl_easy_init();
  if (curl == nullptr) return "no memory";
  const bool is_ipv6 = broker.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + broker.host + "]" : broker.host;
  const std::string url =
      (broker.ca_file.empty() ? "http://" : "https://") + host + ":" + std::to_string(broker.port);
  curl_easy_setopt(curl, CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl, CURLOPT_CONNECT_ONLY, 1L);
  curl_easy_setopt(curl, CURLOPT_PROXY, "");
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_TIMEOUT_MS, kProbeMsMax);
  curl_easy_setopt(curl, CURLOPT_SSL_ENABLE_ALPN, 0L);
  if (!broker.ca_file.empty()) {
    curl_easy_setopt(curl, CURLOPT_CAINFO, broker.ca_file.c_str());
    curl_easy_setopt(curl, CURLOPT_CAPATH, nullptr);
  }
  char detail[CURL_ERROR_SIZE] = "";
  curl_easy_setopt(curl, CURLOPT_ERRORBUFFER, detail);
  const CURLcode code = curl_easy_perform(curl);
  const std::string reason =
      code == CURLE_OK
          ? ""
          : transfer_trouble(curl, code, detail, "mqtt_ca_file must hold its issuer's certificate")
                .reason;
  curl_easy_cleanup(curl);
  return reason;
}

}  // namespace

MqttClient::MqttClient(const NotifySettings& settings, MqttPresence presence, OnOrder on_order)
    : settings_(settings.mqtt),
      presence_(presence),
      on_order_(std::move(on_order)),
      status_topic_(topic(settings.name, "status")),
      order_topics_{topic(settings.name, kHoldTopic), topic(settings.name, kHoldPowerTopic)} {
  mosquitto_lib_init();
  // A broker disconnects a client when another one connects with its id.
  const std::string visit = presence == MqttPresence::kVisits ? "-" + std::to_string(getpid()) : "";
  client_ = mosquitto_new(("bess-notify-" + settings.id + visit).c_str(), true, this);
  if (client_ == nullptr) throw std::bad_alloc();
  using Self = MqttClient*;
  mosquitto_connect_callback_set(
      client_, [](mosquitto*, void* self, int code) { static_cast<Self>(self)->on_connect(code); });
  mosquitto_disconnect_callback_set(
      client_, [](mosquitto*, void* self, int) { static_cast<Self>(self)->on_disconnect(); });
  mosquitto_publish_callback_set(
      client_, [](mosquitto*, void* self, int id) { static_cast<Self>(self)->on_published(id); });
  mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* got) {
    if (got->retain) return;  // an order from before this connection
    const std::string payload(static_cast<const char*>(got->payload),
                              static_cast<std::size_t>(got->payloadlen));
    static_cast<Self>(self)->on_order_(got->topic, payload);
  });
  mosquitto_reconnect_delay_set(client_, 1, kReconnectSMax, true);
  if (presence_ == MqttPresence::kStays) {
    mosquitto_will_set(client_, status_topic_.c_str(), kOffline.size(), kOffline.data(), kQos,
                       true);
  }
  if (!settings_.user.empty()) {
    mosquitto_username_pw_set(client_, settings_.user.c_str(),
                              settings_.password.empty() ? nullptr : settings_.password.c_str());
  }
  if (!settings_.ca_file.empty() &&
      mosquitto_tls_set(client_, settings_.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr) !=
          MOSQ_ERR_SUCCESS) {
    return;  // never unencrypted; find_trouble reports the cause
  }
  mosquitto_loop_start(client_);  // also without a broker; retries without end
  mosquitto_connect_async(client_, settings_.host.c_str(), settings_.port, kKeepAliveS);
}

MqttClient::~MqttClient() {
  const bool was_connected = is_connected();
  if (was_connected && presence_ == MqttPresence::kStays) {
    retain(status_topic_, std::string(kOffline));
    wait_until_sent(std::chrono::milliseconds(settings_.wait_ms_max));
  }
  mosquitto_connect_callback_set(client_, nullptr);
  mosquitto_disconnect_callback_set(client_, nullptr);
  mosquitto_publish_callback_set(client_, nullptr);
  mosquitto_message_callback_set(client_, nullptr);
  mosquitto_disconnect(client_);
  const auto end = [client = client_] {
    mosquitto_loop_stop(client, false);
    mosquitto_destroy(client);
  };
  // Without a connection the library's thread may block for minutes in a connect or a look-up.
  was_connected ? end() : std::thread(end).detach();
}

void MqttClient::retain(const std::string& topic, const std::string& payload) {
  const std::lock_guard lock(mutex_);
  retained_[topic] = payload;
  if (is_connected_) send(topic, payload, true);
}

void MqttClient::publish(const std::string& topic, const std::string& payload) {
  const std::lock_guard lock(mutex_);
  send(topic, payload, false);
}

void MqttClient::send(const std::string& topic, const std::string& payload, bool is_retained) {
  int id = 0;
  const int code = mosquitto_publish(client_, &id, topic.c_str(), static_cast<int>(payload.size()),
                                     payload.data(), kQos, is_retained);
  if (code == MOSQ_ERR_SUCCESS) unacknowledged_.insert(id);
}

bool MqttClient::wait_until_sent(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, patience,
                           [&] { return is_connected_ && unacknowledged_.empty(); });
}

bool MqttClient::is_connected() {
  const std::lock_guard lock(mutex_);
  return is_connected_;
}

bool MqttClient::is_cut_off() {
  constexpr int kInARow = 5;
  const std::lock_guard lock(mutex_);
  return cut_off_ >= kInARow;
}

std::string MqttClient::find_trouble() {
  if (wait_until_sent({})) return "";
  if (is_connected()) return "the broker does not acknowledge: check its load and the network";
  const std::string before = "no connection to the broker: ";
  const std::string trouble = probe_connection(settings_);
  if (!trouble.empty()) return before + trouble;
  const std::lock_guard lock(mutex_);
  if (refusal_ != 0) {
    return before + mosquitto_connack_string(refusal_) +
           " check mqtt_user, mqtt_password_file and the broker's log";
  }
  return before + "reachable, but no MQTT session: check mqtt_port and the broker's log for MQTT";
}

void MqttClient::on_connect(int code) {
  const std::lock_guard lock(mutex_);
  refusal_ = code;
  is_connected_ = code == 0;
  connected_ = std::chrono::steady_clock::now();
  if (is_connected_ && presence_ == MqttPresence::kStays) {
    retained_[status_topic_] = "online";
    for (const auto& [topic, payload] : retained_) send(topic, payload, true);
    for (const std::string& topic : order_topics_) {
      if (on_order_) mosquitto_subscribe(client_, nullptr, topic.c_str(), kQos);
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

void MqttClient::on_published(int message_id) {
  const std::lock_guard lock(mutex_);
  unacknowledged_.erase(message_id);
  changed_.notify_all();
}

}  // namespace bess
