// bess-sim battery: simulates the [battery] of a configuration, or replays a recording.
#pragma once

#include <string>

#include "shared/battery_model.h"
#include "tools/simulators/battery_sim/battery_server.h"
#include "tools/simulators/sim/clock_options.h"

namespace bess {

/// Reads the keys of shared/battery_keys.h. Throws UserError naming file, line and key.
void read_battery_file(const std::string& path, BatteryParameters& battery);

// bess-sim battery --replay: serves a recorded device instead of a simulated one.

struct ReplayOptions {
  std::string path;  ///< empty: no replay
  bool accept_cut = false;
};

/// Serves until stopped. Throws UserError.
void run_replay(const ReplayOptions& options, const BatteryServerSettings& server,
                const ClockOptions& clock);

}  // namespace bess
