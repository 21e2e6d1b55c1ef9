// bess-sim battery --replay: serves a recorded device in place of a simulated one.
#pragma once

#include <string>

#include "tools/battery_sim/battery_server.h"
#include "tools/sim/clock_options.h"

namespace bess {

struct ReplayOptions {
  std::string path;  ///< empty: nothing is replayed
  bool accept_cut = false;
};

/// Serves until it is stopped. Throws UserError.
void run_replay(const ReplayOptions& options, const BatteryServerSettings& server,
                const ClockOptions& clock);

}  // namespace bess
