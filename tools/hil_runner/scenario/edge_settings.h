// Configuration of the edge for a scenario: a file for the real reader, in both times.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <optional>
#include <string>

#include "edge/app/settings/edge_config.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/site/connection_guard.h"
#include "shared/host/minute_file.h"
#include "shared/price_level.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/simulators/site/controller_settings.h"

namespace bess {

// Line of the limit file (edge/core/site/connection_guard.h).

/// Power in W, or any.
inline std::string limit_power_text(std::int32_t power_w) {
  return power_w == kAnyPowerW ? std::string(kAnyPowerText) : std::to_string(power_w);
}

/// Line for a limit event; for a torn limit half of it, as by an interrupted program.
inline std::string limit_line(const ScenarioEvent& event, std::int64_t now_utc_s) {
  const std::string line =
      fmt::format("{} {} {}\n", limit_power_text(event.charge_w),
                  limit_power_text(event.discharge_w), utc_text(now_utc_s + event.for_s).view());
  return event.kind == ScenarioEvent::EventKind::kLimitTorn ? line.substr(0, line.size() / 2)
                                                            : line;
}

/// Addresses of battery and market, and the clock; the defaults are for virtual time.
struct EdgePlaces {
  int battery_port = 1;
  std::string serial_device;
  std::string battery_link;  ///< TOML for a real battery; empty: simulated
  int market_port = 1;
  int meter_port = 2;
  std::optional<ScaledClock> clock{};  ///< empty: virtual time
};

/// Price level of the hours before the start; by default as many as the edge requests.
PriceLevel level_before(const MinuteSeries& prices, std::int64_t start_utc_s, int hours = 72);

std::string edge_settings(const Scenario& scenario, const MinuteSeries& prices,
                          const EdgePlaces& places);

/// Writes the text to `path` and reads it as bess-edge does. Throws UserError naming the scenario
/// and [edge].
EdgeConfig load_edge_settings(const Scenario& scenario, const std::string& path,
                              const std::string& text);

}  // namespace bess
