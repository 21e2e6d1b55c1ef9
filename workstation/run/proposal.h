// A refit held against the run that it may replace: both traded over days that neither was learnt
// or chosen on, each with its own charge carried over, and every decision that would differ.
//
// The student that is judged is the one that would be adopted: its window ends where the judged
// days begin. What those days would have taught it costs less (workstation/README.md, "Refreshed")
// than to let a student drive that nobody can judge.
#pragma once

#include <string>
#include <vector>

#include "shared/action.h"
#include "shared/host/json.h"
#include "workstation/chain/run_config.h"
#include "workstation/env/evaluate.h"
#include "workstation/student/student_file.h"

namespace bess {

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

}  // namespace bess
