// Whether a battery that lies within every key's range can be meant: watts written as megawatts, an
// efficiency that no battery has.
#pragma once

#include <string>

#include "workstation/cli/run_config.h"

namespace bess {

/// Throws UserError naming the keys when power, capacity or their ratio cannot be meant; prints a
/// warning about efficiencies that are unusual. `name` is the file's.
void require_plausible(const RunConfig& config, const std::string& name);

}  // namespace bess
