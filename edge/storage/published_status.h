// How the controller is, put together from all that it leaves: status.json of the state folder and
// of the run folder, and the decision log in both. A disk that dies leaves an old one behind: the
// newest counts, whatever says it, and where nothing does although a controller runs, that is said.
#pragma once

#include <cstdint>
#include <string>

#include "edge/log/record_fields.h"
#include "edge/log/run_status.h"
#include "edge/settings/edge_config.h"
#include "shared/host/json.h"

namespace bess {

// Who a run is, for the status that it publishes: this build, this configuration, this process.

RunIdentity identity_of_run(const EdgeConfig& config);

struct PublishedStatus {
  Json status;  ///< as status.json has it; does not exist when nothing is known
  int holder =
      0;  ///< process of the controller; 0 = none runs, negative = one whose number is not known
  bool is_of_this_run = false;     ///< the status is that process's
  std::int64_t age_ms = 0;         ///< of the status
  std::int64_t cycles_behind = 0;  ///< that status.json was behind the log, whose word counts
  std::string
      unknown;  ///< not empty: a controller runs, or may run, and nothing says how it is; why
};

/// `no_lock`: without asking who holds a lock; the process that the status names counts instead.
PublishedStatus read_published_status(const EdgeConfig& config, bool no_lock);

/// The newer of the metrics files that is as it was written; false when there is none.
bool read_published_metrics(const EdgeConfig& config, std::string& text);

/// Number of the newest record that a status.json knows; 0 = none does.
std::uint64_t published_log_number(const EdgeConfig& config);

/// What the status says of the member at this path of CycleRecord or RunTotals.
template <auto... kPath>
JsonValue field(JsonValue status) {
  constexpr StatusKey kKey = status_key<kPath...>();
  return status[kKey.section][kKey.name];
}

inline double number(JsonValue found) { return found.number().value_or(0); }
inline long long whole(JsonValue found) { return static_cast<long long>(number(found)); }

/// Whole text of a file; false when it cannot be read.
bool read_text(const char* path, std::string& text);

}  // namespace bess
