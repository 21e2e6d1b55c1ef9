// TCP proxy on loopback that can cut its one connection at any moment, like a pulled cable.
#pragma once

#include <poll.h>

#include <atomic>
#include <cstdint>
#include <thread>

#include "tests/support/loopback_socket.h"

namespace bess {

class DroppingProxy {
 public:
  /// `target_port` is on 127.0.0.1 and may close and reopen.
  explicit DroppingProxy(std::uint16_t target_port) : target_port_(target_port) {
    sockaddr_in place = loopback_address();
    listen_fd_ = bind_socket(place);
    listen(listen_fd_, 16);
    port_ = ntohs(place.sin_port);
    thread_ = std::thread([this] { run(); });
  }
  DroppingProxy(const DroppingProxy&) = delete;
  DroppingProxy& operator=(const DroppingProxy&) = delete;
  ~DroppingProxy() {
    stopping_ = true;
    thread_.join();
    close(listen_fd_);
  }

  [[nodiscard]] std::uint16_t port() const { return port_; }
  [[nodiscard]] int connections() const { return connections_; }
  /// Cuts the current connection.
  void drop() { drop_ = true; }

 private:
  void run() {
    while (!stopping_) {
      pollfd waiting{.fd = listen_fd_, .events = POLLIN, .revents = 0};
      if (poll(&waiting, 1, 20) <= 0) continue;
      const int client = accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC);
      const int target = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      const sockaddr_in place = loopback_address(target_port_);
      ++connections_;
      drop_ = false;
      if (connect(target, reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0) {
        pump(client, target);
      }
      close(target);
      close(client);
    }
  }
  void pump(int client, int target) {
    while (!stopping_ && !drop_) {
      pollfd ends[2] = {{.fd = client, .events = POLLIN, .revents = 0},
                        {.fd = target, .events = POLLIN, .revents = 0}};
      if (poll(ends, 2, 1) < 0) return;
      if (ends[0].revents != 0 && !forward(client, target)) return;
      if (ends[1].revents != 0 && !forward(target, client)) return;
    }
  }
  static bool forward(int from, int to) {
    char bytes[512];
    const ssize_t got = recv(from, bytes, sizeof bytes, 0);
    return got > 0 && send(to, bytes, static_cast<std::size_t>(got), MSG_NOSIGNAL) == got;
  }

  std::uint16_t target_port_;
  std::uint16_t port_ = 0;
  int listen_fd_ = -1;
  std::atomic<int> connections_ = 0;
  std::atomic<bool> drop_ = false;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace bess
