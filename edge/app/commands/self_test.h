// Self-test of machine and site for the controller: `bess-edge --self-test`. Writes nothing to the
// battery.
#pragma once

#include <string>

#include "edge/app/settings/edge_config.h"

namespace bess {

/// Prints one line per part: ok, note or FAIL. Exit code 0, or 1 if a part fails.
int run_self_test(const EdgeConfig& config, const std::string& config_path);

}  // namespace bess
