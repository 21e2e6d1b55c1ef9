// Refresh of a run: retraining on the latest prices, evaluation and adoption of the candidate.
// Folders of a run DIR:
//
//   DIR.proposal        candidate: a complete run folder, with the verdict
//   DIR.refused-DATE    rejected candidate, worse or not proved; DATE is its last day
//   DIR.before-DATE     run that a candidate replaced
//
// Files and renames are atomic, and the next step follows from the files that exist: prices, stages
// of the retraining (run_stages.h), verdict, two renames. A killed refresh is therefore continued
// by the next one, with the same bytes as result.
#pragma once

#include <string>
#include <vector>

#include "shared/action.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/feed/elia_fetch.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// Comparison of a candidate with the current run on days that neither was trained or selected on,
// each with its own SoC carried over. The evaluated student is the one to be adopted, so its
// training window ends before these days (cost of the lost days: notebook,
// 2026-11-25_refresh_adopted_and_refused.md).

/// State on the current student's path in which the candidate decides differently.
struct DifferingDecision {
  MarketStep step;
  double soc_frac;
  Action before, now;
};

struct CandidateRun {
  Evaluation before, now;  ///< evaluated days, SoC carried over, final charge valued
  PairedDifference gain;   ///< of the candidate, EUR per day per MWh
  std::size_t decisions = 0;
  std::vector<DifferingDecision> differing;  ///< in time order

  /// Worse by more than the standard error of the paired days.
  [[nodiscard]] bool is_worse() const { return gain.mean + gain.errors.plain < 0; }
};

/// Precondition: `market` has test days.
CandidateRun judge_refit(const StudentFile& before, const StudentFile& now,
                         const MarketSteps& market, const RunConfig& config);

/// Header `utc,price_eur_mwh,paid_eur_mwh,soc,before,now`.
std::string differing_decisions_csv(const CandidateRun& candidate);
std::string candidate_text(const CandidateRun& candidate);

/// Maximum and minimum number of evaluation days of a candidate.
inline constexpr int kJudgedDays = 30;
inline constexpr int kJudgedDaysMin = 14;

struct RefreshRequest {
  std::string run;
  int window_days = 365;
  bool adopt = false;
  std::vector<std::string> prices;  ///< empty: download the latest prices
  PriceInput price_input;
  DayAheadInput day_ahead;            ///< for a run by outlook, with `prices`
  std::string source = kEliaBaseUrl;  ///< of downloaded prices
  std::string day_ahead_source = kEnergyChartsBaseUrl;
};

/// Progress and results go to stdout. Throws UserError.
void refresh(const RefreshRequest& request);

}  // namespace bess
