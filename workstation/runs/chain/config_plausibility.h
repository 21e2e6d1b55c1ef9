// Plausibility checks of a configuration across keys: values in MW instead of W, unrealistic
// efficiencies, training times of years.
#pragma once

#include <string>

#include "workstation/runs/chain/run_config.h"

namespace bess {

/// Throws UserError naming the keys when power, capacity or their ratio is implausible; warns about
/// unusual efficiencies. `name` is the file's.
void require_plausible(const RunConfig& config, const std::string& name);

/// Warning on stderr when the training of a network takes more than an hour.
void warn_long_training(const RunConfig& config);

}  // namespace bess
