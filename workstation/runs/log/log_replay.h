// What another student would have decided in the cycles of a log, beside what was decided there:
// asked of a student before it may drive.
//
// The money of a decision that differs is an estimate: the energy by which it differs, at the most
// power that the log orders for two minutes, bought or sold at that price and given back at the
// day's mean.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "shared/nn/student_net.h"
#include "workstation/runs/log/log_input.h"

namespace bess {

struct ReplayedDay {
  std::string date;
  int compared = 0;  ///< cycles in which the student was asked
  int differing = 0;
  double gained_eur = 0;          ///< by the differing ones
  double prices_eur_per_mwh = 0;  ///< the sum over its cycles that have one
  int priced = 0;
  double mwh_moved = 0;  ///< that the new decisions charge more
};

/// A cycle in which it would have decided otherwise.
struct ReplayedCycle {
  std::int64_t utc_s = 0;
  double price_eur_per_mwh = 0;
  double soc_frac = 0;
  Action before{};
  Action now{};
};

struct LogReplay {
  std::uint32_t student_hash = 0;
  std::vector<ReplayedDay> days;      ///< oldest first; of those with a cycle to compare
  std::vector<ReplayedCycle> others;  ///< all that differ, oldest first
  /// By what was decided, then by what would be.
  std::array<std::array<int, kActionCount>, kActionCount> decisions{};
  int compared = 0;
  int differing = 0;
  int without_context = 0;  ///< by outlook: cycles of a log that has no break-even price
  double gained_eur = 0;

  /// 0 where nothing was compared.
  [[nodiscard]] double differing_percent() const {
    return compared == 0 ? 0 : 100.0 * differing / compared;
  }
  [[nodiscard]] std::string text() const;
  /// The answer of --json (answers.schema.json).
  [[nodiscard]] Json json() const;
};

/// Throws UserError where the log holds no decision to compare.
LogReplay replay_log(const CycleLog& log, const LoggedSpan& span, const StudentNet& student);

}  // namespace bess
