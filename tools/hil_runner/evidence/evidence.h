// What a run leaves behind to be judged: the battery's own record, and the records of the edge's
// ring to hold against it. The same in virtual and in wall time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edge/core/control/control_types.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

// What somebody who knows only the maker's table of registers reads off the wire, at one instant.

struct WireReading {
  std::int64_t utc_ns = 0;
  std::optional<double> soc_frac;   ///< as the device shows it
  std::optional<double> power_w;    ///< likewise, charge positive
  std::optional<double> ordered_w;  ///< as written; nothing: no order stands in the registers

  [[nodiscard]] bool shows_the_same(const WireReading& other) const {
    return soc_frac == other.soc_frac && power_w == other.power_w && ordered_w == other.ordered_w;
  }
};

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

// What the battery was commanded at any instant, by its own record.

struct CommandInForce {
  bool is_driven = false;  ///< it follows an order; else its own mode
  double power_w = 0;
};

class CommandTimeline {
 public:
  explicit CommandTimeline(const std::vector<DispatchEvent>& events) : events_(events) {}

  [[nodiscard]] CommandInForce at(std::int64_t utc_ns) const {
    const auto next = std::ranges::upper_bound(events_, utc_ns, {}, &DispatchEvent::utc_ns);
    if (next == events_.begin()) return {};
    const DispatchEvent& last = *(next - 1);
    if (last.kind != DispatchEvent::Kind::kOrder || last.duration_s <= 0) return {};
    return {.is_driven = true, .power_w = last.power_w};
  }

 private:
  const std::vector<DispatchEvent>& events_;
};

}  // namespace bess
