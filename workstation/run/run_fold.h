// A run on one fold of a walk-forward: learnt on the days before a month, or before any stretch of
// days, and judged by that.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/env/market_steps.h"
#include "workstation/market/series/local_date.h"

namespace bess {

/// As 'bess-train backtest' has it unless told otherwise.
inline constexpr int kFoldWindowDays = 120;

/// A stretch of local days that a run is judged by, and the days before it that it learns from.
struct FoldDays {
  LocalDate first, last;
  int window_days;

  /// "2025-06-01 to 2025-06-30, 120 days before"
  [[nodiscard]] std::string name() const;
};
/// None of a month's name.
std::optional<FoldDays> parse_fold_days(const std::string& name);

/// The months that can be traded, "2024-06", in order. Throws UserError when none can.
std::vector<std::string> fold_months(const MarketSteps& market);

/// What a run on this month, or FoldDays::name(), sees (backtest/walk_forward.h). Throws UserError
/// when it is not traded.
MarketSteps market_of_fold(const MarketSteps& market, const std::string& name);

}  // namespace bess
