// What became of one scenario in one of the two times, for whoever tells of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/judge/judge.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

struct Outcome {
  Scenario scenario;
  bool is_virtual = true;
  bool is_real = false;  ///< it drove a battery that was there already
  std::string skipped;   ///< why it did not run; empty: it ran
  std::string error;     ///< why it could not be run to its end, or not judged; empty: it was
  bool is_late = false;  ///< not judged: the machine was too late for the scenario's pace
  std::vector<Finding> findings;
  double seconds = 0;           ///< of wall time
  std::uint64_t signature = 0;  ///< of all that battery and edge recorded; virtual time alone
  Evidence evidence;
  MinuteSeries prices;
  std::string kept_folder;  ///< where the files of a failed run in wall time lie

  [[nodiscard]] bool passed() const { return skipped.empty() && error.empty() && findings.empty(); }
  [[nodiscard]] bool failed() const { return !error.empty() || !findings.empty(); }
  /// "late" is a failure of the machine, not of what was tested.
  [[nodiscard]] const char* verdict() const {
    return !skipped.empty() ? "skipped" : passed() ? "passed" : is_late ? "late" : "failed";
  }
  [[nodiscard]] const char* time() const {
    return is_virtual ? "virtual" : is_real ? "real" : "wall";
  }
};

/// "expected X, seen Y at 2023-03-26T00:14:00Z (minute 14.0): soc_window", the first of them.
std::string complaint(const Outcome& outcome);

}  // namespace bess
