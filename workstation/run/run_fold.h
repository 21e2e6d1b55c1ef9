// A run on one fold of a walk-forward: learnt on the days before a month, judged by that month.
#pragma once

#include <string>
#include <vector>

#include "workstation/env/market_steps.h"

namespace bess {

/// As 'bess-train backtest' has it unless told otherwise.
inline constexpr int kFoldWindowDays = 120;

/// The months that can be traded, "2024-06", in order. Throws UserError when none can.
std::vector<std::string> fold_months(const MarketSteps& market);

/// What a run on this month sees (backtest/walk_forward.h). Throws UserError when it is not traded.
MarketSteps market_of_fold(const MarketSteps& market, const std::string& month);

/// The days of a fold that something is fitted on.
std::vector<MarketDay> fitted_days(const MarketSteps& fold);

}  // namespace bess
