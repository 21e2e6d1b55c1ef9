// Run and judgement of one scenario in one of the two times.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/judge/judge.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/wall/wall_run.h"

namespace bess {

struct Outcome {
  Scenario scenario;
  bool is_virtual = true;
  bool is_real = false;  ///< with a real battery
  std::string skipped;   ///< reason not to run; empty: it ran
  std::string error;     ///< reason of an incomplete run; empty: judged
  bool is_late = false;  ///< not judged: the machine was too slow
  std::vector<Finding> findings;
  double seconds = 0;           ///< wall time
  std::uint64_t signature = 0;  ///< of battery trace and decision log; virtual time only
  Evidence evidence;
  MinuteSeries prices;
  std::string kept_folder;  ///< files of a failed run in wall time

  [[nodiscard]] bool passed() const { return skipped.empty() && error.empty() && findings.empty(); }
  [[nodiscard]] bool failed() const { return !error.empty() || !findings.empty(); }
  /// "late" is a failure of the machine, not of the tested program.
  [[nodiscard]] const char* verdict() const {
    return !skipped.empty() ? "skipped" : passed() ? "passed" : is_late ? "late" : "failed";
  }
  [[nodiscard]] const char* time() const {
    return is_virtual ? "virtual" : is_real ? "real" : "wall";
  }
};

/// "expected X, seen Y at 2023-03-26T00:14:00Z (minute 14.0): soc_window", the first of them.
std::string complaint(const Outcome& outcome);

/// Errors of the scenario are in the outcome. Throws Interrupted on a stop request.
Outcome run_scenario(const Scenario& scenario, bool in_virtual_time, const WallSite& site);

}  // namespace bess
