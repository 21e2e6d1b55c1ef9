// Whether what lies within every key's range can be meant: watts written as megawatts, an
// efficiency that no battery has, a training of years.
#pragma once

#include <string>

#include "workstation/runs/chain/run_config.h"

namespace bess {

/// Throws UserError naming the keys when power, capacity or their ratio cannot be meant; prints a
/// warning about efficiencies that are unusual. `name` is the file's.
void require_plausible(const RunConfig& config, const std::string& name);

/// What a network's training is likely to take on its cores; 0 for the stochastic program.
double training_hours(const TrainOptions& options);
/// One line on stderr, before anything starts, when that is more than an hour.
void warn_long_training(const RunConfig& config);

}  // namespace bess
