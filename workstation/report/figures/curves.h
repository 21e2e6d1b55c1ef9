// Curves of the report: learning and distillation as CSV, written and read back, their smoothing,
// and the histogram of prices.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/distillation/distil.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/rl/train.h"
#include "workstation/report/figures/picture_table.h"

namespace bess {

// How often each observed price occurs on training and on test days.

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

/// Neighbours on either side of a validation profit that its smoothed value is the mean of.
inline constexpr int kSmoothingReach = 2;

std::string training_curve_csv(const std::vector<CurvePoint>& curve);
std::string distil_curve_csv(const std::vector<DistilPoint>& curve);

/// Mean over each point and up to `reach` neighbours on either side.
std::vector<double> centred_mean(const std::vector<double>& values, int reach);

/// Read back what the writers wrote; throw UserError naming `name` and the line otherwise.
std::vector<CurvePoint> parse_training_curve_csv(std::string_view text, std::string_view name);
std::vector<DistilPoint> parse_distil_curve_csv(std::string_view text, std::string_view name);

}  // namespace bess
