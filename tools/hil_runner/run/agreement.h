// Whether the two times say the same: what a scenario's edge ordered in virtual time, held against what bess-edge ordered in
// wall time, cycle by cycle.
#pragma once

#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

struct Agreement {
  int scenarios = 0;    ///< that ran in both times
  int cycles = 0;       ///< that both of them logged
  int otherwise = 0;    ///< of those, ordered otherwise
  std::string first{};  ///< of those, by scenario and minute; empty: none
};

/// Power that differs by a few watts is the same order: a quarter-hour's energy is counted to the second.
Agreement agreement_of(const std::vector<Outcome>& outcomes);

/// "1560 of 1563 cycles of 60 scenarios ordered alike in both times, not ..."; empty where none ran in both.
std::string agreement_line(const Agreement& agreement);

}  // namespace bess
