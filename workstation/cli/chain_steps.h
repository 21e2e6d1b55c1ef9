// Steps of the chain that `run` shares with the single subcommands; each is defined where its subcommand is.
#pragma once

#include <string>

#include "workstation/rl/train.h"

namespace bess {

/// One line for the files made from this training.
std::string training_provenance(const std::string& prices, const TrainOptions& options,
                                const TrainResult& result);
/// One line on stderr when the support of C51 is too narrow for the values met.
void warn_narrow_support(const TrainOptions& options, const TrainResult& result);

}  // namespace bess
