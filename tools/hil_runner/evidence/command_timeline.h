// What the battery was commanded at any instant, by its own record.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tools/battery_sim/simulated_battery.h"

namespace bess {

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
