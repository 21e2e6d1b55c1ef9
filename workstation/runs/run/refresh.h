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
#include <string>
#include <vector>

#include "shared/action.h"
#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// A refit held against the run that it may replace: both traded over days that neither was learnt
// or chosen on, each with its own charge carried over, and every decision that would differ.
//
// The student that is judged is the one that would be adopted: its window ends where the judged
// days begin. What those days would have taught it costs less (workstation/README.md, "Refreshed")
// than to let a student drive that nobody can judge.

/// A decision of the run's student, where it was with its charge, that the refit would not take.
struct DifferingDecision {
  MarketStep step;
  double soc_frac;
  Action before, now;
};

struct Proposal {
  Evaluation before, now;  ///< the judged days, SoC carried over, the charge left valued
  PairedDifference gain;   ///< of the refit, EUR per day per MWh
  std::size_t decisions = 0;
  std::vector<DifferingDecision> differing;  ///< in the order of time

  /// Behind by more than the standard error of its paired days.
  [[nodiscard]] bool is_worse() const { return gain.mean + gain.standard_error < 0; }
};

/// Precondition: `market` has test days.
Proposal judge_refit(const StudentFile& before, const StudentFile& now, const MarketSteps& market,
                     const RunConfig& config);

/// Header `utc,price_eur_mwh,paid_eur_mwh,soc,before,now`.
std::string differing_decisions_csv(const Proposal& proposal);
std::string proposal_text(const Proposal& proposal);
Json proposal_json(const Proposal& proposal);

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
