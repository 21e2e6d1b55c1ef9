// Comparisons of runs: the same scenario in virtual and in wall time, cycle by cycle, and the same
// scenario without each of its parts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "tools/hil_runner/run/outcome.h"

namespace bess {

// Whether a scenario can fail: it is run without each of its parts, and each time must differ.

/// A finding for each part that changes nothing and is not excused, and for each excuse of one
/// that does. `outcome` is of the whole scenario in virtual time. Throws Interrupted when a stop
/// was requested.
std::vector<Finding> judge_parts(const Outcome& outcome);

/// A cycle that both have logged, and ordered otherwise.
struct OtherOrder {
  CycleRecord in_virtual;
  CycleRecord in_wall;
  /// What it met otherwise: "link", "price", "words", "meter", "battery", "before"; empty: it
  /// decided otherwise on the same, which no run may.
  std::string met;
};

struct Agreement {
  std::string scenario;
  std::int64_t start_utc_s = 0;
  int cycles = 0;  ///< that both of them logged
  std::vector<OtherOrder> otherwise{};
  std::string not_compared{};  ///< why there is nothing to compare; empty: there is

  /// Every order is the same, or was made on something else; where this machine was too late,
  /// nothing is said.
  [[nodiscard]] bool holds() const;
};

/// Of each scenario that was to run in both times, in the order of the outcomes. Power that differs
/// by a few watts is the same order: a quarter-hour's energy is counted to the second.
std::vector<Agreement> agreements_of(const std::vector<Outcome>& outcomes);

/// A row a scenario, then each order that differs, then the sum.
std::string agreement_table(const std::vector<Agreement>& agreements);
Json agreement_json(const std::vector<Agreement>& agreements);
/// "1560 of 1563 cycles of 60 scenarios ordered alike in both times, 3 otherwise on something else,
/// 0 on the same"; empty where none ran in both.
std::string agreement_line(const std::vector<Agreement>& agreements);

}  // namespace bess
