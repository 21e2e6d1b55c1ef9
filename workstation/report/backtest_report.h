// Report of a walk-forward backtest, by month and in total: table, CSV, JSON, and a page with
// cumulative profit and drawdown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/backtest/walk_forward.h"

namespace bess {

/// Traded month and the training of its policies.
struct BacktestMonth {
  std::string name;         ///< Fold::month
  std::size_t fitted_days;  ///< number of training days
  FoldRegimes regimes{};
};

/// Gains are day-by-day differences to the first policy.
struct BacktestResults {
  std::vector<WalkForward> policies;  ///< not empty; the same days for all
  std::vector<BacktestMonth> months;  ///< as in WalkForward::by_month
  std::vector<SkippedMonth> skipped;
  int window_days;
  std::string provenance;     ///< one line: prices, configuration
  std::string learnt_from{};  ///< identity: prices, seed and configuration
};

/// One line per policy: profit, gain, cycles, drawdown; then the gain by month.
std::string format_backtest_table(const BacktestResults& results);
/// Header `month,policy,...`, one row per month and policy; "all" is the total.
std::string backtest_csv(const BacktestResults& results);
/// Header `date,policy,...`, one row per day and policy.
std::string backtest_days_csv(const BacktestResults& results);
Json backtest_json(const BacktestResults& results);
/// Writes backtest.html into `folder`.
void write_backtest_page(const BacktestResults& results, const std::filesystem::path& folder);

}  // namespace bess
