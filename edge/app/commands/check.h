// `bess-edge --check`: what would be done with these settings, by battery, meter and prices as they
// answer now. Nothing is written to the battery.
#pragma once

#include <string>

#include "edge/app/settings/edge_config.h"

namespace bess {

// What bess-prices says of the price server, asked once: for --check and --self-test.

struct PriceCheck {
  bool is_well = false;
  std::string lines;  ///< what it printed, complaints last
};

/// Runs `bess-prices --check`, the one beside this program.
PriceCheck check_prices(const std::string& config_path);

/// `path`: of the settings. One line a finding on stdout, what is to be mended on stderr. Exit code
/// 0, or 1 where a run would not do.
int run_check(const EdgeConfig& config, const std::string& path);

}  // namespace bess
