// Pair of connected pseudo terminals: the two ends of a serial line, each with a device name.
// Destruction hangs up both ends, like a removed adapter.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>

namespace bess {

class PtyBridge {
 public:
  PtyBridge() : ends_{open_end(), open_end()} {
    thread_ = std::thread([this] { run(); });
  }
  PtyBridge(const PtyBridge&) = delete;
  PtyBridge& operator=(const PtyBridge&) = delete;
  ~PtyBridge() {
    stopping_ = true;
    thread_.join();
    for (const End& end : ends_) {
      close(end.terminal);
      close(end.master);
    }
  }
  /// Device names of the two ends.
  [[nodiscard]] const std::string& device(int end) const {
    return ends_[static_cast<std::size_t>(end)].name;
  }

 private:
  struct End {
    int master = -1;
    int terminal = -1;  ///< kept open, to prevent a hang-up when a program closes its end
    std::string name;
  };
  static End open_end() {
    End end;
    end.master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    if (end.master < 0 || grantpt(end.master) != 0 || unlockpt(end.master) != 0) return end;
    char name[128] = {};
    if (ptsname_r(end.master, name, sizeof name) != 0) return end;
    end.name = name;
    end.terminal = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    termios raw{};
    tcgetattr(end.terminal, &raw);
    cfmakeraw(&raw);
    tcsetattr(end.terminal, TCSANOW, &raw);
    return end;
  }
  void run() {
    while (!stopping_) {
      pollfd events[2] = {{.fd = ends_[0].master, .events = POLLIN, .revents = 0},
                          {.fd = ends_[1].master, .events = POLLIN, .revents = 0}};
      if (poll(events, 2, 20) <= 0) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        if ((events[i].revents & POLLIN) != 0) copy(ends_[i].master, ends_[1 - i].master);
      }
    }
  }
  static void copy(int from, int to) {
    char bytes[512];
    const ssize_t got = read(from, bytes, sizeof bytes);
    if (got <= 0) return;
    const ssize_t put = write(to, bytes, static_cast<std::size_t>(got));
    static_cast<void>(put);  // a full line loses bytes, like a real one
  }

  std::array<End, 2> ends_;
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace bess
