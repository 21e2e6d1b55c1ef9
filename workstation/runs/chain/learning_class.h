// Learning class: configurations with the same student. The battery is scaled to the default
// capacity at its C-rate, so that 4 MW / 8 MWh and 4 kW / 8 kWh, whose students would differ only
// by rounding, are one class.
#pragma once

#include <string>
#include <vector>

#include "workstation/runs/chain/run_config.h"

namespace bess {

// Differences of a configuration from the defaults.

struct ChangedKey {
  std::string key;  ///< "[section] name"
  std::string value;
  std::string standard;
};

/// In the order of the list of keys; without seed, threads and rules.
std::vector<ChangedKey> changed_keys(const RunConfig& config);

/// "[market] observation_delay_min = 2 (default 1); ...", or that all keys have their default.
std::string changed_keys_text(const RunConfig& config);

/// `config` at the canonical size, with the C-rate rounded to twelve digits. With a step it becomes
/// the nearest of 1, 1 + step, (1 + step)^2, ... and their reciprocals.
RunConfig canonical(RunConfig config, double rate_step_percent = 0);

/// Learning keys of a configuration, one per line, and rules.
std::string learning_key(const RunConfig& config, const std::string& rules);

}  // namespace bess
