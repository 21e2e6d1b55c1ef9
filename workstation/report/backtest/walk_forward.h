// Walk-forward backtest: fit on the days before a month, freeze, trade that month, roll on. A fold
// holds nothing later than its own month, so what is fitted in it cannot have seen what it is
// judged by; the battery's charge goes over from fold to fold as it would.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

/// One traded month with the window that its policies are fitted on. Of the window, local days 21
/// to 25 are validation days and all others training days; the month's are test days.
struct Fold {
  std::string month;  ///< "2024-06"; of other stretches their first day, "2024-06-08"
  MarketSteps market;
};

/// Of the price regimes, those that a fold's window lies in and those that it trades.
struct FoldRegimes {
  std::vector<const PriceRegime*> fitted, traded;
  /// A boundary of the market lies in the fold.
  [[nodiscard]] bool crosses() const { return fitted != traded || traded.size() > 1; }
};
FoldRegimes regimes_of(const Fold& fold);

/// A month that is not traded, and why.
struct SkippedMonth {
  std::string month;
  std::string reason;
};

struct Folds {
  std::vector<Fold> traded;
  std::vector<SkippedMonth> skipped;
};

struct FoldPlan {
  int window_days;
  int lag_days = 0;     ///< between the window and what is traded
  int traded_days = 0;  ///< by one fold; 0: a calendar month
};

/// A fold for each month, or stretch of days, that has at least half of its window in complete
/// days, and training and validation days among them. Throws UserError when none has.
Folds make_folds(const MarketSteps& market, const FoldPlan& plan);

/// The days of `market` from `first` to `last`, with their window.
std::variant<Fold, SkippedMonth> make_fold(const MarketSteps& market, const std::string& name,
                                           const LocalDate& first, const LocalDate& last,
                                           const FoldPlan& plan);

/// What a policy did, in the order of the days.
struct WalkForward {
  std::string name;
  Evaluation total;
  std::vector<std::string> months;   ///< as in Folds::traded
  std::vector<Evaluation> by_month;  ///< parallel to `months`
  Evaluation day_reset{};  ///< the days, each from the initial SoC; empty unless asked for

  /// As drawdown.h defines it, EUR per MWh of capacity.
  [[nodiscard]] double drawdown_eur_per_mwh() const;
  /// Profit after each day, EUR per MWh of capacity.
  [[nodiscard]] std::vector<double> cumulative_eur_per_mwh() const;
};

/// Makes the policy of a fold, from its training and validation days alone.
using FoldPolicy = std::function<std::shared_ptr<Policy>(const Fold&)>;

/// Trades fold after fold. A policy that sees the future, the bound, plans over `market` as a
/// whole. Appends every step to `records` when it is given.
WalkForward walk_forward(const std::string& name, const Folds& folds, const FoldPolicy& make,
                         const BatteryParameters& battery, double initial_soc_frac,
                         const MarketSteps& market, bool and_day_reset = false,
                         std::vector<StepRecord>* records = nullptr);

}  // namespace bess
