// The backtest that belongs to a run: the folder "backtest" in the run's own, made of the same
// prices, seed and configuration.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "workstation/report/figures/walk_forward_figure.h"
#include "workstation/run/run_record.h"

namespace bess {

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
