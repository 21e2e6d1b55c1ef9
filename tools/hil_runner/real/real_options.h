// The command line's way to a real battery: nothing of it is guessed.
#pragma once

#include <optional>
#include <string>

#include "shared/host/command_line.h"
#include "tools/hil_runner/real/real_battery.h"

namespace bess {

struct RealOptions {
  std::string address, map, variant;
  bool is_sure = false;
  std::optional<int> unit, baud;
  std::optional<double> capacity_wh, power_w, soc_min_frac, soc_max_frac;
  int time_scale = 1;
};

/// `options` must outlive the command.
void add_real_options(ProgramCommand& command, RealOptions& options);

/// Nothing without --real. Throws UserError when the options contradict each other.
std::optional<RealBattery> real_battery(const RealOptions& options);

}  // namespace bess
