// What bess-prices says of the price server, asked once: for --check and --self-test.
#pragma once

#include <string>

namespace bess {

struct PriceCheck {
  bool is_well = false;
  std::string lines;  ///< what it printed, complaints last
};

/// Runs `bess-prices --check`, the one beside this program.
PriceCheck check_prices(const std::string& config_path);

}  // namespace bess
