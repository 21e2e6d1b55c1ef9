// The operator's settings, from a commented TOML file (bess-edge.toml is the documented example).
// Everything ends in fixed-size structs before the loop starts.
#pragma once

#include <cstdint>
#include <string>

#include "edge/control_loop.h"
#include "edge/modbus_battery.h"
#include "edge/price_feed.h"
#include "edge/registers/register_map.h"
#include "shared/fixed_text.h"
#include "shared/scaled_clock.h"

namespace bess {

struct EdgeConfig {
  ControlSettings control;
  BatteryLinkSettings link;
  PriceFeedSettings price;
  RegisterMap map;
  ScaledClock clock;
  FixedText<511> map_path;
  FixedText<511> state_folder = "/var/lib/bess";  ///< what must outlive a restart
  FixedText<511> log_csv;
  std::int32_t capacity_wh = 8'000;  ///< what the battery must report, within the tolerance
  std::int32_t capacity_tolerance_percent = 25;
  std::int32_t start_timeout_s = 10;   ///< wall time to reach the battery at start
  bool start_without_battery = false;  ///< true: keep trying in safe mode instead of exiting
  bool require_synchronised_clock = true;
};

/// Reads the file and the register map it names. False with one line ("file:line: what, and the
/// mend").
bool load_edge_config(const std::string& path, EdgeConfig& config, std::string& error);

}  // namespace bess
