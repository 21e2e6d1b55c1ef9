// Run plan from the command line and the run folder.
#pragma once

#include <string>

#include "shared/host/minute_file.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

struct RunRequest {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;  ///< none: with `resume` that of the folder
  RuleFiles rule_files;
  std::string prices;        ///< empty: built-in market, or with `resume` those of the folder
  std::string from_teacher;  ///< file or run folder; empty: train one, or with `resume` the same
  std::string out;           ///< run folder
  bool resume = false;
};

struct RunPlan {
  RunFolder folder;
  RunRecord record;  ///< with the finished stages
  MinuteSeries series;
};

/// With `resume`, options not given keep their value. Writes nothing. Throws UserError when the
/// folder contains another run (naming keys and both values), the same run without `resume`, or
/// files without a record; and when an output is also an input.
RunPlan plan_run(const RunRequest& request);

/// Checked prices of a record in `folder`. Throws UserError.
MinuteSeries prices_of_run(const RunRecord& record, const RunFolder& folder,
                           const AcceptedFindings& accepted);

}  // namespace bess
