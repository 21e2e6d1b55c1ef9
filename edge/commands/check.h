// `bess-edge --check`: what would be done with these settings, by battery, meter and prices as they
// answer now. Nothing is written to the battery.
#pragma once

#include <string>

#include "edge/settings/edge_config.h"

namespace bess {

/// `path`: of the settings. One line a finding on stdout, what is to be mended on stderr. Exit code
/// 0, or 1 where a run would not do.
int run_check(const EdgeConfig& config, const std::string& path);

}  // namespace bess
