// Log replay with another student, to check it before adoption.
//
// The value of a changed decision is an estimate: two minutes at the highest logged power, bought
// or sold at that price and offset at the day's mean price.
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
  int compared = 0;  ///< cycles decided by the student
  int differing = 0;
  double gained_eur = 0;          ///< by changed decisions
  double prices_eur_per_mwh = 0;  ///< sum over cycles with a price
  int priced = 0;
  double mwh_moved = 0;  ///< additional charge by the new decisions
};

/// Cycle with a changed decision.
struct ReplayedCycle {
  std::int64_t utc_s = 0;
  double price_eur_per_mwh = 0;
  double soc_frac = 0;
  Action before{};
  Action now{};
};

struct LogReplay {
  std::uint32_t student_hash = 0;
  std::vector<ReplayedDay> days;      ///< days with a compared cycle, oldest first
  std::vector<ReplayedCycle> others;  ///< all changed decisions, oldest first
  /// [logged decision][new decision].
  std::array<std::array<int, kActionCount>, kActionCount> decisions{};
  int compared = 0;  ///< not 0
  int differing = 0;
  int without_context = 0;  ///< by outlook: cycles without a break-even price
  double gained_eur = 0;

  [[nodiscard]] double differing_percent() const { return 100.0 * differing / compared; }
  [[nodiscard]] std::string text() const;
  /// Answer of --json (answers.schema.json).
  [[nodiscard]] Json json() const;
};

/// Throws UserError when the log has no decision to compare.
LogReplay replay_log(const CycleLog& log, const LoggedSpan& span, const StudentNet& student);

}  // namespace bess
