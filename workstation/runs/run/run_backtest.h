// Backtest of a run, in its folder "backtest" and with the same prices, seed and configuration; and
// runs on one fold.
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

// Run on one fold: trained on the days before a month or period, and evaluated on it.

/// Default of 'bess-train backtest'.
inline constexpr int kFoldWindowDays = 120;

/// Evaluation period of a run, local days, and the length of its training window.
struct FoldDays {
  LocalDate first, last;
  int window_days;

  /// "2025-06-01 to 2025-06-30, 120 days before"
  [[nodiscard]] std::string name() const;
};
/// Nullopt for the name of a month.
std::optional<FoldDays> parse_fold_days(const std::string& name);

/// Tradable months, "2024-06", in order. Throws UserError when there is none.
std::vector<std::string> fold_months(const MarketSteps& market);

/// Market of a run on this month or FoldDays::name() (../report/backtest/walk_forward.h). Throws
/// UserError when it is not tradable.
MarketSteps market_of_fold(const MarketSteps& market, const std::string& name);

/// Folder within a run's folder, and file names.
inline constexpr const char* kRunsBacktest = "backtest";
inline constexpr const char* kBacktestJson = "backtest.json";
inline constexpr const char* kBacktestPage = "backtest.html";
/// Policy name of the whole chain, retrained for each fold.
inline constexpr const char* kChainName = "student";

/// Placeholder of the run's folder in its files.
inline constexpr std::string_view kRunPlace = "RUN/";
/// Replaces the placeholder by `folder`, for output.
std::string with_run_folder(std::string text, const std::filesystem::path& folder);

/// Identity of a backtest, to compare with a run: prices, seed and configuration.
std::string learning_identity(const std::string& prices_hash, const RunConfig& config);

/// Result of the backtest in the run's folder; none when missing or of another identity.
WalkForwardOfRun walk_forward_of(const RunFolder& folder, const RunRecord& record);

}  // namespace bess
