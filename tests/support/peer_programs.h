// Independent programs: paths, availability, and their use by tests.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <initializer_list>
#include <string>
#include <vector>

#include "tests/support/program_output.h"

namespace bess {

inline constexpr const char* kPython = "/usr/bin/python3";
inline constexpr const char* kMbpoll = "/usr/bin/mbpoll";
inline constexpr const char* kSocat = "/usr/bin/socat";

/// "X is not installed" for the first missing one, Python and its `modules` ("a, b") included; else
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

/// A test that is skipped if one of them is missing.
class PeerTest : public ::testing::Test {
 protected:
  explicit PeerTest(const std::string& modules, std::initializer_list<const char*> programs = {})
      : missing_(missing_peer(modules, programs)) {}
  void SetUp() override {
    if (!missing_.empty()) GTEST_SKIP() << missing_;
  }

 private:
  std::string missing_;
};

/// Behind the last colon of "listening on HOST:PORT".
inline std::string port_in(const std::string& ready) {
  return ready.substr(ready.find_last_of(':') + 1);
}

/// Options of a peer: the site's simulated time.
template <typename Site>
std::vector<std::string> simulated_time_of(const Site& site) {
  return {"--scale",     std::to_string(site.clock.scale),
          "--start-s",   std::to_string(site.clock.anchor_utc_s),
          "--anchor-ns", std::to_string(site.anchor_ns())};
}

/// master_peer.py, at the simulated battery of a site.
template <typename Site, typename Map>
std::vector<std::string> master_peer(const Site& site, const Map& m,
                                     const std::vector<std::string>& more = {}) {
  return joined(joined({kPython, BESS_SOURCE_DIR "/tests/system/peers/master_peer.py", "--map",
                        m.map, "--variant", m.variant, "--port", std::to_string(site.battery_port)},
                       simulated_time_of(site)),
                more);
}

}  // namespace bess
