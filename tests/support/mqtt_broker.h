// MQTT broker (Debian's mosquitto), and a subscriber to everything that is published.
#pragma once

#include <mosquitto.h>
#include <signal.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "shared/host/child_process.h"
#include "tests/support/loopback_socket.h"
#include "tests/support/temporary_folder.h"

namespace bess {

/// Debian's broker on a free port of loopback.
class Broker {
 public:
  static constexpr const char* kProgram = "/usr/sbin/mosquitto";

  /// `keys`: more lines of its configuration. Started by root it stays root, and may read a test's
  /// files.
  Broker(const TemporaryFolder& folder, std::uint16_t port,
         const std::string& keys = "allow_anonymous true\n")
      : port_(port) {
    config_ = folder.write("mosquitto.conf",
                           "user root\nlistener " + std::to_string(port) + " 127.0.0.1\n" + keys);
    start();
  }
  /// Returns when it listens, which takes seconds on a busy machine.
  void start() {
    process_ = std::make_unique<ChildProcess>(std::vector<std::string>{kProgram, "-c", config_});
    await_listener(port_);
  }
  void stop() { process_.reset(); }
  /// Accepts connections without answering until resumed.
  void freeze() const { process_->signal(SIGSTOP); }
  void thaw() const { process_->signal(SIGCONT); }
  [[nodiscard]] std::uint16_t port() const { return port_; }

 private:
  std::uint16_t port_;
  std::string config_;
  std::unique_ptr<ChildProcess> process_;
};

/// Everything that is published below a topic, as it comes.
class Listener {
 public:
  Listener(std::uint16_t port, const char* pattern) : pattern_(pattern) {
    mosquitto_lib_init();
    client_ = mosquitto_new(nullptr, true, this);
    mosquitto_connect_callback_set(client_, [](mosquitto* client, void* self, int) {
      mosquitto_subscribe(client, nullptr, static_cast<Listener*>(self)->pattern_, 1);
    });
    mosquitto_subscribe_callback_set(client_, [](mosquitto*, void* self, int, int, const int*) {
      static_cast<Listener*>(self)->begin();
    });
    mosquitto_message_callback_set(client_,
                                   [](mosquitto*, void* self, const mosquitto_message* message) {
                                     static_cast<Listener*>(self)->take(*message);
                                   });
    mosquitto_loop_start(client_);
    mosquitto_connect_async(client_, "127.0.0.1", port, 60);
    // Unretained messages only reach existing subscribers.
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::seconds(30), [&] { return is_listening_; });
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener() {
    mosquitto_disconnect(client_);
    mosquitto_loop_stop(client_, false);
    mosquitto_destroy(client_);
    mosquitto_lib_cleanup();
  }

  /// Waits for a payload with this piece on a topic with this end; empty after 30 s.
  std::string await(const std::string& topic_end, const std::string& piece) {
    std::unique_lock lock(mutex_);
    std::string found;
    changed_.wait_for(lock, std::chrono::seconds(30), [&] {
      for (const auto& [topic, payload] : messages_) {
        const bool is_it = topic.ends_with(topic_end) && payload.find(piece) != payload.npos;
        if (is_it) found = payload;
      }
      return !found.empty();
    });
    return found;
  }
  void publish(const std::string& topic, const std::string& payload, bool is_retained = false) {
    mosquitto_publish(client_, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                      payload.data(), 1, is_retained);
  }
  std::size_t count(const std::string& topic_end) {
    const std::lock_guard lock(mutex_);
    std::size_t count = 0;
    for (const auto& message : messages_) count += message.first.ends_with(topic_end) ? 1 : 0;
    return count;
  }

 private:
  void begin() {
    const std::lock_guard lock(mutex_);
    is_listening_ = true;
    changed_.notify_all();
  }
  void take(const mosquitto_message& message) {
    const std::lock_guard lock(mutex_);
    messages_.emplace_back(message.topic,
                           std::string(static_cast<const char*>(message.payload),
                                       static_cast<std::size_t>(message.payloadlen)));
    changed_.notify_all();
  }

  const char* pattern_;
  mosquitto* client_;
  bool is_listening_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::pair<std::string, std::string>> messages_;
};

}  // namespace bess
