// A run refreshed: learnt anew from what was published since, as a proposal beside it, and put in
// its place when it is not worse. Folders, of a run DIR:
//
//   DIR.proposal        the refit: a run folder of its own, and what the judging says of it
//   DIR.refused-DATE    a proposal that was worse, or not proved; DATE is the last day it saw
//   DIR.before-DATE     the run that a proposal replaced
//
// Files appear whole and folders change their names at once, and what is next is read from what is
// there: the prices once, the refit stage by stage (run_stages.h), the judgement last of all, the
// two names. So a refresh that was killed anywhere is gone on with by the next one, to the same
// bytes.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>

#include "shared/host/minute_file.h"

namespace bess {

/// Days that a proposal is judged by, at most; of fewer than the least none is made.
inline constexpr int kJudgedDays = 30;
inline constexpr int kJudgedDaysMin = 14;

struct RefreshRequest {
  std::filesystem::path run;
  int window_days;
  bool adopt = false;
  /// Writes the newest prices as a minute file, and those of day-ahead, judged, for a run by
  /// outlook.
  std::function<void(const std::filesystem::path& out)> bring_prices;
  std::function<void(const std::filesystem::path& out, const MinuteSeries& settled)>
      bring_day_ahead;
};

/// What it does and finds goes to `messages`. Throws UserError.
void refresh(const RefreshRequest& request, std::FILE* messages);

}  // namespace bess
