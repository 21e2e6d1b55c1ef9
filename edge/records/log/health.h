// Health of the controller, a pure function of its published status: two signals (the process is
// alive; the last cycle was good) become one word and the reasons for it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "edge/records/log/run_status.h"

namespace bess {

struct HealthInputs {
  bool is_running = false;            ///< a process holds the lock
  const RunStatus* status = nullptr;  ///< null: none is known
  bool is_of_this_run = false;        ///< it was written by that process
  std::int64_t age_ms = 0;            ///< of the status
  std::int64_t cycles_behind = 0;     ///< that the stored status is behind the log
  CardWear wear{};                    ///< of the state folder's device, now
  bool disk_is_full = false;          ///< of the state folder, or it is read-only
  std::string_view unknown{};  ///< not empty: a process runs, and nothing says how it is; why
  std::string_view update_trouble{};  ///< what the last upgrade ended badly with; empty = none
};

enum class HealthLevel { kOk = 0, kDegraded = 1, kNotRunning = 3 };  ///< also the exit codes

struct Health {
  HealthLevel level = HealthLevel::kOk;
  std::vector<std::string> reasons;  ///< one each; empty when ok
};

Health assess_health(const HealthInputs& in);
std::string_view health_name(HealthLevel level);

}  // namespace bess
