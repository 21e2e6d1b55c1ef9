// The command bess-sim battery: acts the [battery] of a configuration, or replays a recording.
#pragma once

#include <string>

#include "shared/battery_model.h"
#include "tools/simulators/battery_sim/battery_server.h"
#include "tools/simulators/sim/clock_options.h"

namespace bess {

/// Sets what the file has of shared/battery_keys.h. Throws UserError naming file, line and key.
void read_battery_file(const std::string& path, BatteryParameters& battery);

// bess-sim battery --replay: serves a recorded device in place of a simulated one.

struct ReplayOptions {
  std::string path;  ///< empty: nothing is replayed
  bool accept_cut = false;
};

/// Serves until it is stopped. Throws UserError.
void run_replay(const ReplayOptions& options, const BatteryServerSettings& server,
                const ClockOptions& clock);

}  // namespace bess
