// How often each observed price occurs on training and on test days.
#pragma once

#include <vector>

#include "workstation/env/market_steps.h"
#include "workstation/report/figures/picture_table.h"

namespace bess {

inline constexpr double kPriceBinEurPerMwh = 20;

struct PriceHistogram {
  std::vector<double> train;  ///< observed prices, ascending
  std::vector<double> test;
  double low,
      high;  ///< left edges of the first and the last bin: multiples of it, the far tails left out

  /// Percent of `sorted` in each bin from low to high.
  [[nodiscard]] std::vector<double> percent_by_bin(const std::vector<double>& sorted) const;
  /// Percent of `sorted` beyond them on either side.
  [[nodiscard]] double percent_outside(const std::vector<double>& sorted) const;
};

PriceHistogram price_histogram(const MarketSteps& market);

/// A row a bin.
PictureTable histogram_table(const std::string& name, const PriceHistogram& shown);

}  // namespace bess
