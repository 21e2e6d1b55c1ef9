// The edge's configuration of a scenario: a file for the real reader, in both times.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edge/loop/control_settings.h"
#include "edge/settings/edge_config.h"
#include "shared/host/minute_file.h"
#include "shared/price_level.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/site/site_clock.h"

namespace bess {

/// Where battery and market are, and the clock; as it stands: virtual time.
struct EdgePlaces {
  int battery_port = 1;
  std::string serial_device;
  std::string battery_link;  ///< TOML that leads to a real one; empty: a simulated one, here
  int market_port = 1;
  int meter_port = 2;
  std::optional<SiteClock> clock{};  ///< empty: virtual time
};

/// The price level that the hours before the start have led to; by default as many as the edge asks
/// for.
PriceLevel level_before(const MinuteSeries& prices, std::int64_t start_utc_s, int hours = 72);

std::string edge_settings(const Scenario& scenario, const MinuteSeries& prices,
                          const EdgePlaces& places);

/// Writes the text to `path` and reads it as bess-edge does. Throws UserError that names the
/// scenario: its [edge] is what can be wrong.
EdgeConfig load_edge_settings(const Scenario& scenario, const std::string& path,
                              const std::string& text);

}  // namespace bess
