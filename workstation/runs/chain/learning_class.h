// Learning class: configurations whose students are the same. What a learning stage reads of a
// battery is brought to one canonical size: its power becomes a C-rate at the capacity of the
// defaults, so that 4 MW / 8 MWh and 4 kW / 8 kWh, whose students would differ by a rounding of the
// last digit, are one class.
#pragma once

#include <string>
#include <vector>

#include "workstation/runs/chain/run_config.h"

namespace bess {

// What a configuration says that its defaults do not.

struct ChangedKey {
  std::string key;  ///< "[section] name"
  std::string value;
  std::string standard;
};

/// In the order of the list of keys; seed, threads and rules are no keys.
std::vector<ChangedKey> changed_keys(const RunConfig& config);

/// "[market] observation_delay_min = 2 (default 1); ...", or that there are none.
std::string changed_keys_text(const RunConfig& config);

/// `config` at the canonical size. The C-rate is taken to twelve digits: 3300 W / 10000 Wh and 3.3
/// kW / 10 kWh are the same one. With a step it becomes the nearest of 1, 1 + step, (1 + step)^2...
/// and their reciprocals: at most half a step away.
RunConfig canonical(RunConfig config, double rate_step_percent = 0);

/// All that a learning stage reads of a configuration and of rules, a line each.
std::string learning_key(const RunConfig& config, const std::string& rules);

}  // namespace bess
