// Signal handlers of another process.
#pragma once

#include <unistd.h>

#include <fstream>
#include <string>

namespace bess {

/// Waits until it has a handler for this signal; false after one minute.
inline bool catches(pid_t pid, int number) {
  for (int ms = 0; ms < 60'000; ++ms) {
    std::ifstream status("/proc/" + std::to_string(pid) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (!line.starts_with("SigCgt:")) continue;
      if (std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1) return true;
    }
    usleep(1'000);
  }
  return false;
}

}  // namespace bess
