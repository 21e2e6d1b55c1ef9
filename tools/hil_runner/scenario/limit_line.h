// The line by which a scenario's other program limits the battery (edge/site/connection_guard.h).
#pragma once

#include <fmt/core.h>

#include <string>

#include "edge/site/connection_guard.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// As a scenario says it and as the line and the command line have it: watts, or any.
inline std::string limit_power_text(std::int32_t power_w) {
  return power_w == kAnyPowerW ? std::string(kAnyPowerText) : std::to_string(power_w);
}

/// Of an event that limits; one that tears leaves what a program writes that is interrupted: half
/// of it.
inline std::string limit_line(const ScenarioEvent& event, std::int64_t now_utc_s) {
  const std::string line =
      fmt::format("{} {} {}\n", limit_power_text(event.charge_w),
                  limit_power_text(event.discharge_w), utc_text(now_utc_s + event.for_s).view());
  return event.does == ScenarioEvent::Does::kLimitTorn ? line.substr(0, line.size() / 2) : line;
}

}  // namespace bess
