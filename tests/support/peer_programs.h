// Programs that share nothing with bess: where they are, and whether they are there.
#pragma once

#include <unistd.h>

#include <initializer_list>
#include <string>

#include "shared/host/child_process.h"

namespace bess {

inline constexpr const char* kPython = "/usr/bin/python3";
inline constexpr const char* kMbpoll = "/usr/bin/mbpoll";
inline constexpr const char* kSocat = "/usr/bin/socat";

/// "X is not installed" for the first that is not, Python and its `modules` ("a, b") included; else
/// nothing.
inline std::string missing_peer(const std::string& modules,
                                std::initializer_list<const char*> programs = {}) {
  for (const char* program : programs) {
    if (access(program, X_OK) != 0) return std::string(program) + " is not installed";
  }
  if (access(kPython, X_OK) != 0) return std::string(kPython) + " is not installed";
  ChildProcess probe({kPython, "-c", "import " + modules});
  return probe.wait() == 0 ? "" : "not all of " + modules + " is installed";
}

}  // namespace bess
