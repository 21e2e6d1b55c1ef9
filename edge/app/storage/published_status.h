// Published status of the controller for the commands of bess-edge: stored status and decision log,
// both in the state folder and in the run folder. The newest is used, because a failed disk keeps
// an old one. If a controller runs without a status, `unknown` has the cause.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/run_status.h"

namespace bess {

/// Identity of a run: this build, configuration and process.
RunIdentity identity_of_run(const EdgeConfig& config);

struct PublishedStatus {
  std::optional<RunStatus> status;  ///< of the newest known run
  int holder = 0;                   ///< process of the controller; 0 = none, negative = unknown id
  bool is_of_this_run = false;      ///< the status is of that process
  std::int64_t age_ms = 0;          ///< of the status
  std::int64_t cycles_behind = 0;   ///< control cycles from the stored status to the log
  std::string unknown;              ///< why the state of a running controller is unknown, or empty
};

/// `no_lock`: check the process id in the status instead of the lock.
PublishedStatus read_published_status(const EdgeConfig& config, bool no_lock);

/// Number of the newest record in a stored status; 0 = none.
std::uint64_t published_log_number(const EdgeConfig& config);

}  // namespace bess
