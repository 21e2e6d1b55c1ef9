// The state of the controller for bess-edge's own commands: the status that it stores in the state
// folder and in the run folder, and the decision log in both. A disk that dies leaves an old one
// behind: the newest counts, and where nothing is known although a controller runs, that is said.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/run_status.h"

namespace bess {

// Who a run is, for the status that it publishes: this build, this configuration, this process.

RunIdentity identity_of_run(const EdgeConfig& config);

struct PublishedStatus {
  std::optional<RunStatus> status;  ///< of the newest run that is known
  int holder =
      0;  ///< process of the controller; 0 = none runs, negative = one whose number is not known
  bool is_of_this_run = false;     ///< the status is that process's
  std::int64_t age_ms = 0;         ///< of the status
  std::int64_t cycles_behind = 0;  ///< that the stored status was behind the log, whose word counts
  std::string
      unknown;  ///< not empty: a controller runs, or may run, and nothing says how it is; why
};

/// `no_lock`: without asking who holds a lock; the process that the status names counts instead.
PublishedStatus read_published_status(const EdgeConfig& config, bool no_lock);

/// Number of the newest record that a stored status knows; 0 = none does.
std::uint64_t published_log_number(const EdgeConfig& config);

/// Whole text of a file; false when it cannot be read.
bool read_text(const char* path, std::string& text);

}  // namespace bess
