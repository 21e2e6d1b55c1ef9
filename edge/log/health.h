// Is the controller well? A pure function of the published status, for `bess-edge status`: two
// signals (the process is alive; the last cycle was good) become one word and the reasons for it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct HealthInputs {
  bool is_running = false;      ///< a process holds the lock
  bool is_of_this_run = false;  ///< the status was written by that process
  std::int64_t age_ms = 0;      ///< of the status
  std::int64_t cadence_ms = 120'000;
  std::int64_t cycles = 0;
  std::int64_t unanswered_orders = 0;  ///< in a row
  std::int64_t weak_answers = 0;       ///< in a row
  std::int64_t lost_orders = 0;        ///< of the newest `judged_orders`
  std::int64_t judged_orders = 0;
  bool orders_are_lost = false;           ///< too many of them
  std::int64_t energy_share_percent = 0;  ///< these five: ResponseFindings, 0 where all is well
  std::int64_t rest_loss_w = 0;
  std::int64_t ramp_w_per_s = 0;
  std::int64_t locked_readings = 0;  ///< in a row
  std::int64_t wrong_energy_e6 = 0;
  std::string_view trip = "none";  ///< the reason's name
  std::string_view mode;
  std::string_view reason;
  std::string_view battery_status;
  std::string_view price_status;
  bool battery_warns = false;
  std::string_view meter_status = "ok";  ///< also where there is no meter
  bool meter_is_mismatch = false;
  bool house_is_implausible = false;
  std::int64_t house_w = 0;  ///< of the last cycle
  std::string_view limit_status = "ok";
  std::string_view lost_reading;  ///< name of the point that could not be read; empty: none
  std::string_view cut_reading;   ///< of one beyond its range
  bool disk_is_slow = false;
  bool disk_is_failing = false;
  bool run_folder_is_failing = false;
  std::int64_t cycles_behind = 0;       ///< that status.json is behind the log, whose word counts
  int disk_used_life_percent = 0;       ///< of the state folder's device; 0: not told, or not worn
  int disk_spare_level = 0;             ///< as of CardWear
  std::int64_t file_system_errors = 0;  ///< that the kernel has counted there
  bool disk_is_full = false;            ///< of the state folder, or it is read-only
  bool price_step_held = false;
  double held_eur_per_mwh = 0;  ///< price of the row that waits for the next
  bool has_price = false;
  double price_eur_per_mwh = 0;
  bool price_frozen = false;           ///< it has not moved, under new stamps
  std::int64_t price_unchanged_s = 0;  ///< for so long
  std::int64_t unplanned_s = 0;        ///< without a plan on published day-ahead prices
  std::string_view day_ahead_status = "ok";
  bool hold_is_unreadable = false;
  std::string_view unknown;         ///< not empty: a process runs, and nothing says how it is; why
  std::string_view update_trouble;  ///< what the last upgrade ended badly with; empty = none
};

enum class HealthLevel { kOk = 0, kDegraded = 1, kNotRunning = 3 };  ///< also the exit codes

struct Health {
  HealthLevel level = HealthLevel::kOk;
  std::vector<std::string> reasons;  ///< one each; empty when ok
};

Health assess_health(const HealthInputs& in);
std::string_view health_name(HealthLevel level);

}  // namespace bess
