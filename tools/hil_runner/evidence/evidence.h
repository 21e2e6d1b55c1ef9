// What a run leaves behind to be judged: the battery's own record, and the edge's log to hold against it.
// The same in virtual and in wall time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/control/mode.h"
#include "shared/action.h"
#include "tools/battery_sim/simulated_battery.h"

namespace bess {

/// A row of the edge's log.
struct LoggedCycle {
  std::int64_t utc_s = 0;
  Mode mode = Mode::kStart;
  bool has_measurement = false;
  std::int32_t soc_e4 = 0;
  bool has_price = false;
  std::int64_t price_minute_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  bool has_student_action = false;
  Action student_action = Action::kIdle;
  std::int16_t context_class = 0;
  std::int32_t ordered_power_w = 0;
  std::int32_t battery_power_w = 0;
  std::string reason{};
  bool written = false;

  friend bool operator==(const LoggedCycle&, const LoggedCycle&) = default;
};

struct Evidence {
  std::vector<DispatchEvent> orders;  ///< that the battery was given, and how each ended
  std::vector<MinuteRecord> minutes;  ///< that it exchanged
  std::vector<LoggedCycle> log;
  bool order_ends_by_itself = true;   ///< the device has a timer, by its map
  std::int32_t order_duration_s = 0;  ///< of that timer
  std::int32_t edge_exit_code = 0;    ///< of the last edge; 128 + signal where one ended it
  std::string edge_last_line;         ///< what it said at the end
  bool is_alive_at_end = false;       ///< of the simulators: they answered until they were stopped
  double slack_s = 0;                 ///< simulated seconds that this machine may be late by
};

}  // namespace bess
