// The backtest of a run: the folder "backtest" in the run's own, made of the same prices, seed and
// configuration; and the runs that learn one fold each.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/data/env/market_steps.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/report/figures/walk_forward_figure.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

// A run on one fold of a walk-forward: learnt on the days before a month, or before any stretch of
// days, and judged by that.

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

/// What a run on this month, or FoldDays::name(), sees (../report/backtest/walk_forward.h). Throws
/// UserError when it is not traded.
MarketSteps market_of_fold(const MarketSteps& market, const std::string& name);

/// Where it lies in a run's folder, and its files' names.
inline constexpr const char* kRunsBacktest = "backtest";
inline constexpr const char* kBacktestJson = "backtest.json";
inline constexpr const char* kBacktestPage = "backtest.html";
/// The whole chain, learnt anew for each fold.
inline constexpr const char* kChainName = "student";

/// The run's own folder in what its files say.
inline constexpr std::string_view kRunPlace = "RUN/";
/// With `folder` in its place, to be shown.
std::string with_run_folder(std::string text, const std::filesystem::path& folder);

/// What a backtest is made of, to be held against a run: prices, seed and every key, in one text.
std::string learning_identity(const std::string& prices_hash, const RunConfig& config);

/// The figure of the backtest in the run's folder. None when there is none, or it is of something
/// else.
WalkForwardOfRun walk_forward_of(const RunFolder& folder, const RunRecord& record);

}  // namespace bess
