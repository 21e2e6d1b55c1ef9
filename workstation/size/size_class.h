// What a battery of one C-rate earns under the linear terms of a contract, walk-forward, of any
// size: profit, throughput and peaks of two batteries that differ in size alone are as their sizes,
// so a class is traded once at the size of the defaults (chain/learning_class.h).
#pragma once

#include <string>
#include <vector>

#include "workstation/backtest/walk_forward.h"
#include "workstation/size/size_plan.h"

namespace bess {

/// Of a calendar month: the highest mean power taken from the grid in a quarter-hour, as a share of
/// the rated power.
struct MonthPeak {
  std::string month;  ///< local, "2024-08"
  double power_share;
};

struct SizeClass {
  BatteryParameters battery;
  Evaluation traded;                ///< the charge left at the end is valued
  std::vector<MonthPeak> peaks;     ///< of the traded months
  double share_of_foresight = 0.0;  ///< NaN when foresight earns nothing
};

/// What is asked of the market: days, policies by name, threads.
struct SizeTrial {
  const MarketSteps& market;
  const Folds& folds;
  std::string policy;
  int threads;
};

/// A class for each of `configs`, which are canonical. Throws UserError.
std::vector<SizeClass> trade_classes(const std::vector<RunConfig>& configs, const SizeTrial& trial);

/// Highest quarter-hour of each local month; `steps` ascending. Energy of a step that two
/// quarter-hours share is each one's by half.
std::vector<MonthPeak> month_peaks(const std::vector<StepRecord>& steps, double power_w_max);

}  // namespace bess
