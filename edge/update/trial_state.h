// What is kept of this machine's upgrades, in /var/lib/bess-update: `state` (key=value lines and
// their checksum), its copy beside it, the history of all upgrades, and metrics. `bess-edge trial`
// alone writes it; `status` and `history` read it. Where a card forgets, the copy counts; where
// both are lost, that is told, and what runs stays.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "edge/update/trial.h"

namespace bess {

inline constexpr const char* kUpdateFolder = "/var/lib/bess-update";

struct ReadTrialState {
  TrialState state;    ///< phase kUnknown where no package is installed, kFailed where it is lost
  std::string damage;  ///< what was found damaged, for the journal; empty = nothing
};
ReadTrialState read_trial_state(const std::string& folder);

/// Both files and the metrics, on the disk before it returns. False with one line in `error`.
bool write_trial_state(const std::string& folder, const TrialState& state, std::string& error);

/// For Prometheus.
std::string trial_metrics(const TrialState& state);

/// For people, in one line; empty without phase.
std::string update_note(const TrialState& state);

/// What a person does about dpkg's half work; empty where it needs nothing. `delivered` is "iHR1.0"
/// or "ii 1.0".
std::string dpkg_mend(std::string_view delivered);

/// What health says of the last upgrade, until the next one or `bess-edge trial dismiss`; empty
/// when it did not end badly.
std::string update_trouble(const TrialState& state);

inline constexpr std::string_view kUpdateEvents[] = {
    "trying",     "confirmed", "comparing", "going_back", "rolled_back", "failed",
    "broken_off", "refused",   "dismissed", "allowed",    "withdrawn"};

/// One line of the history.
struct UpdateEvent {
  std::string utc;
  std::string event;  ///< one of kUpdateEvents
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
bool add_to_history(const std::string& folder, const UpdateEvent& event);

}  // namespace bess
