// What a walk-forward backtest brought: by month and in total, as a table for the terminal, CSV,
// JSON and a page with the cumulative profit and its falls.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/backtest/walk_forward.h"

namespace bess {

/// Gains are day-by-day differences to the first policy.
struct BacktestResults {
  std::vector<WalkForward> policies;  ///< not empty; the same months and days for all
  std::vector<std::size_t>
      fitted_days;  ///< of each month: on how many days before it it was fitted
  std::vector<SkippedMonth> skipped;
  int window_days;
  double capacity_mwh;
  std::string provenance;              ///< a line: prices, configuration
  std::string learnt_from{};           ///< by which a run knows its own: prices, seed and every key
  std::vector<FoldRegimes> regimes{};  ///< of each month
};

/// One line a policy: profit, gain, cycles, drawdown; then the gain by month.
std::string format_backtest_table(const BacktestResults& results);
/// Header `month,policy,...`, one row a month and policy; the month of the whole is "all".
std::string backtest_csv(const BacktestResults& results);
/// Header `date,policy,...`, one row a day and policy.
std::string backtest_days_csv(const BacktestResults& results);
Json backtest_json(const BacktestResults& results);
/// Writes backtest.html and its figure into `folder`. Throws UserError without gnuplot.
void write_backtest_page(const BacktestResults& results, const std::filesystem::path& folder);

}  // namespace bess
