// `bess-edge --self-test`: can this machine run the controller at this site? Each part that it
// stands on is tried once; nothing is written to the battery.
#pragma once

#include <string>

#include "edge/app/settings/edge_config.h"

namespace bess {

/// A table on stdout, one line a part: ok, note or FAIL. Exit code 0, or 1 when a part fails.
int run_self_test(const EdgeConfig& config, const std::string& config_path);

}  // namespace bess
