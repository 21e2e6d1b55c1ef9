// What a run is to be, from the command line and from what its folder knows already; and whether it
// may be.
#pragma once

#include <optional>
#include <string>

#include "shared/host/minute_file.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/price_input.h"
#include "workstation/runs/chain/rule_files.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

struct RunRequest {
  CommonOptions common;
  PriceInput price_input;
  DayAheadInput day_ahead;  ///< none: with `resume` what the folder says
  RuleFiles rule_files;
  std::string prices;        ///< empty: the built-in market, or with `resume` what the folder says
  std::string from_teacher;  ///< its file, or its run's folder; empty: train one, or the same
  std::filesystem::path out;
  bool resume = false;
};

struct RunPlan {
  RunFolder folder;
  RunRecord record;  ///< with what is done already
  MinuteSeries series;
};

/// With `resume` whatever the request leaves unsaid is the folder's. Writes nothing. Throws
/// UserError when the folder holds another run, naming each key that differs and both values; the
/// same run and `resume` is not given; or files of a run without its record; and when an output is
/// one of the inputs.
RunPlan plan_run(const RunRequest& request);

/// The series that a record in `folder` names, judged. Throws UserError.
MinuteSeries prices_of_run(const RunRecord& record, const RunFolder& folder,
                           const AcceptedFindings& accepted);

}  // namespace bess
