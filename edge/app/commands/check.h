// Check of settings, battery, meter and prices: `bess-edge --check`; and self-test of machine and
// site for the controller: `bess-edge --self-test`. Both write nothing to the battery.
#pragma once

#include <string>

#include "edge/app/settings/edge_config.h"

namespace bess {

/// Result of `bess-prices --check`, for --check and --self-test.
struct PriceCheck {
  bool is_well = false;
  std::string lines;  ///< its output, then its errors
};

/// Runs bess-prices from the folder of this program.
PriceCheck check_prices(const std::string& config_path);

/// `path`: settings file. Findings go to stdout, errors to stderr. Exit code 0, or 1 if the
/// controller would not run.
int run_check(const EdgeConfig& config, const std::string& path);

/// Prints one line per part: ok, note or FAIL. Exit code 0, or 1 if a part fails.
int run_self_test(const EdgeConfig& config, const std::string& config_path);

}  // namespace bess
