// Health of the controller, a pure function of its published status: one word and its alerts.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "edge/records/log/run_status.h"

namespace bess {

struct HealthInputs {
  bool is_running = false;            ///< a process holds the lock
  const RunStatus* status = nullptr;  ///< null: unknown
  bool is_of_this_run = false;        ///< written by that process
  std::int64_t age_ms = 0;            ///< of the status
  std::int64_t cycles_behind = 0;     ///< control cycles from the stored status to the log
  StorageWear wear{};                 ///< of the state folder's device
  bool disk_is_full = false;          ///< of the state folder, or it is read-only
  std::string_view unknown{};         ///< why the state of the running process is unknown, or empty
  std::string_view update_trouble{};  ///< error of the last upgrade, or empty
};

enum class HealthLevel { kOk = 0, kDegraded = 1, kNotRunning = 3 };  ///< also the exit codes

struct HealthAlert {
  std::string_view code;  ///< static; one outage has one code from its first failure on
  std::string line;
};

struct Health {
  HealthLevel level = HealthLevel::kOk;
  std::vector<HealthAlert> alerts;  ///< empty when ok
};

Health assess_health(const HealthInputs& in);
std::string_view health_name(HealthLevel level);

}  // namespace bess
