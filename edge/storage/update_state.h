// What bess-update (edge/update/) keeps of this machine's upgrades: which version is on trial, confirmed or rolled
// back, and the history of all of them. Only read here, by `status` and `history`; bess-update writes it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bess {

inline constexpr const char* kUpdateFolder = "/var/lib/bess-update";

struct UpdateState {
  std::string
      phase;  ///< "upgrading", "trying", "confirmed", "going_back", "rolled_back", "failed"; "hidden" from this user; empty = unknown
  std::string version;
  std::string previous;  ///< the version that is kept beside; empty = none
  std::string refused;   ///< the version that was rolled back; empty = none
  std::string reason;    ///< why
  std::string since_utc;
  std::int64_t good_cycles = 0;
  std::int64_t needed_cycles = 0;
};

/// Without phase where no package is installed.
UpdateState read_update_state(const std::string& folder);

/// For people, in one line; empty without phase.
std::string update_note(const UpdateState& state);

/// What health says of the last upgrade, until the next one or `bess-update dismiss`; empty when it did not end badly.
std::string update_trouble(const UpdateState& state);

/// One line of the history.
struct UpdateEvent {
  std::string utc;
  std::string event;  ///< "trying", "confirmed", "going_back", "rolled_back", "failed", "dismissed"
  std::string version;
  std::string student;        ///< hash of the weights, 8 hexadecimal digits
  std::string header_sha256;  ///< of the exported header, which holds the certificate
  std::string reason;
};

struct UpdateHistory {
  std::vector<UpdateEvent> events;  ///< oldest first
  int damaged_lines = 0;            ///< torn by a power cut, or no such line: left out
  std::string trouble;              ///< why there is none; empty = it was read
};
UpdateHistory read_update_history(const std::string& folder);

}  // namespace bess
