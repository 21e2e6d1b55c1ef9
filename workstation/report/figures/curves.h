// Curves of the report: training and distillation curves as CSV, smoothing, and price histogram.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/rl/train.h"
#include "workstation/report/figures/html.h"

namespace bess {

// Histogram of observed prices on training and test days.

inline constexpr double kPriceBinEurPerMwh = 20;

struct PriceHistogram {
  std::vector<double> train;  ///< observed prices, ascending
  std::vector<double> test;
  double low,
      high;  ///< left edges of the first and last bin, without the far tails

  /// Percent of `sorted` in each bin from low to high.
  [[nodiscard]] std::vector<double> percent_by_bin(const std::vector<double>& sorted) const;
  /// Percent of `sorted` outside these bins.
  [[nodiscard]] double percent_outside(const std::vector<double>& sorted) const;
};

PriceHistogram price_histogram(const MarketSteps& market);

/// One row per bin.
PictureFile histogram_file(const PriceHistogram& shown);

/// Neighbours on either side in the moving average of validation profits.
inline constexpr int kSmoothingReach = 2;

std::string training_curve_csv(const std::vector<CurvePoint>& curve);
std::string distil_curve_csv(const std::vector<DistilPoint>& curve);

/// Mean over each point and up to `reach` neighbours on either side.
std::vector<double> centred_mean(const std::vector<double>& values, int reach);

/// Read the CSV; throw UserError naming `name` and the line.
std::vector<CurvePoint> parse_training_curve_csv(std::string_view text, std::string_view name);
std::vector<DistilPoint> parse_distil_curve_csv(std::string_view text, std::string_view name);

}  // namespace bess
