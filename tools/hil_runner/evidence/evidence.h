// Evidence of a run: battery trace and decision log. The same in virtual and in wall time.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edge/core/control/control_types.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

// Values on the wire at one instant, decoded with the manufacturer's register table only.

struct WireReading {
  std::int64_t utc_ns = 0;
  std::optional<double> soc_frac;   ///< as displayed by the device
  std::optional<double> power_w;    ///< likewise, charge positive
  std::optional<double> ordered_w;  ///< as written; empty: no order in the registers

  [[nodiscard]] bool shows_the_same(const WireReading& other) const {
    return soc_frac == other.soc_frac && power_w == other.power_w && ordered_w == other.ordered_w;
  }
};

struct Evidence {
  std::vector<DispatchEvent> orders;  ///< received by the battery, with their ends
  std::vector<MinuteRecord> minutes;  ///< energy exchanged
  std::vector<CycleRecord> log;       ///< as in the edge's ring, the oldest first
  std::vector<WireReading> wire;      ///< decoded by the witness; empty: no witness
  std::uint64_t sent = 0;           ///< checksum of all frames of the edge and their times; virtual
  std::int32_t edge_exit_code = 0;  ///< of the last edge; 128 + signal if killed
  std::string edge_last_line;       ///< last line of its output
  bool is_alive_at_end = false;     ///< simulators answered until they were stopped
  double slack_s = 0;               ///< tolerated lateness of this machine, simulated s
};

}  // namespace bess
