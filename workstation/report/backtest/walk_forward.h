// Walk-forward backtest: fit on the days before a month, trade that month, repeat. A fold contains
// no later prices, so policies cannot have seen their evaluation days; the SoC is carried over from
// fold to fold.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

/// Traded month with its training window: local days 21 to 25 of the window are validation days,
/// the others training days; days of the month are test days.
struct Fold {
  std::string month;  ///< "2024-06"; for other periods the first day, "2024-06-08"
  MarketSteps market;
};

/// Price regimes of a fold's window and of its traded days.
struct FoldRegimes {
  std::vector<const PriceRegime*> fitted, traded;
  /// The fold crosses a regime boundary.
  [[nodiscard]] bool crosses() const { return fitted != traded || traded.size() > 1; }
};
FoldRegimes regimes_of(const Fold& fold);

/// Month that is not traded.
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
  int lag_days = 0;     ///< between window and traded days
  int traded_days = 0;  ///< per fold; 0: a calendar month
};

/// One fold for each month or period with at least half of its window in complete days, including
/// training and validation days. Throws UserError when there is none.
Folds make_folds(const MarketSteps& market, const FoldPlan& plan);

/// Fold of the days from `first` to `last`.
std::variant<Fold, SkippedMonth> make_fold(const MarketSteps& market, const std::string& name,
                                           const LocalDate& first, const LocalDate& last,
                                           const FoldPlan& plan);

/// Results of a policy, in order of days.
struct WalkForward {
  std::string name;
  Evaluation total{};
  std::vector<Evaluation> by_month{};  ///< as in Folds::traded
  Evaluation day_reset{};              ///< day-reset accounting; empty unless requested

  /// Defined in evaluate.h, EUR per MWh of capacity.
  [[nodiscard]] double drawdown_eur_per_mwh() const;
  /// Profit after each day, EUR per MWh of capacity.
  [[nodiscard]] std::vector<double> cumulative_eur_per_mwh() const;
};

/// Makes the policy of a fold from its training and validation days.
using FoldPolicy = std::function<std::shared_ptr<Policy>(const Fold&)>;

/// Trades all folds in order. A policy that sees the future plans over the whole `market`. Appends
/// steps to `records` if given.
WalkForward walk_forward(const std::string& name, const Folds& folds, const FoldPolicy& make,
                         const BatteryParameters& battery, double initial_soc_frac,
                         const MarketSteps& market, bool and_day_reset = false,
                         std::vector<StepRecord>* records = nullptr);

}  // namespace bess
