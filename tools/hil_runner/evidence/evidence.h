// What a run leaves behind to be judged: the battery's own record, and the records of the edge's
// ring to hold against it. The same in virtual and in wall time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/control/control_types.h"
#include "tools/battery_sim/simulated_battery.h"
#include "tools/hil_runner/evidence/wire_reading.h"

namespace bess {

struct Evidence {
  std::vector<DispatchEvent> orders;  ///< that the battery was given, and how each ended
  std::vector<MinuteRecord> minutes;  ///< that it exchanged
  std::vector<CycleRecord> log;       ///< as the edge's ring keeps it, the oldest first
  std::vector<WireReading> wire;      ///< as a witness reads it; empty: nobody was asked
  std::uint64_t sent = 0;             ///< all frames of the edge and when, in one number; virtual
  bool order_ends_by_itself = true;   ///< the device has a timer, by its map
  std::int32_t order_duration_s = 0;  ///< of that timer
  std::int32_t edge_exit_code = 0;    ///< of the last edge; 128 + signal where one ended it
  std::string edge_last_line;         ///< what it said at the end
  bool is_alive_at_end = false;       ///< of the simulators: they answered until they were stopped
  double slack_s = 0;                 ///< simulated seconds that this machine may be late by
};

}  // namespace bess
