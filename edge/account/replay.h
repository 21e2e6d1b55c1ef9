// What this program's student would have decided in the cycles of the log, beside what was decided:
// asked of a new version before it may drive.
//
// The money of a decision that differs is an estimate: the energy by which it differs, at full
// power for two minutes, bought or sold at that price and given back at the day's mean.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "edge/log/log_reader.h"
#include "shared/host/json.h"

namespace bess {

struct ReplayedDay {
  std::int32_t local_day = 0;  ///< as 20231126
  int compared = 0;            ///< cycles in which the student was asked
  int differing = 0;
  double gained_eur = 0;  ///< by the differing ones
};

/// A cycle in which it would have decided otherwise.
struct ReplayedCycle {
  std::int64_t utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
  std::int32_t soc_e4 = 0;
  Action before{};
  Action now{};
};

struct Replay {
  std::vector<ReplayedDay> days;      ///< the oldest first; of those with a cycle to compare
  std::vector<ReplayedCycle> others;  ///< all that differ, the oldest first
  /// By what was decided, then by what would be.
  std::array<std::array<int, kActionCount>, kActionCount> decisions{};
  int compared = 0;
  int differing = 0;
  double gained_eur = 0;

  /// 0 where nothing was compared.
  [[nodiscard]] double differing_share() const {
    return compared == 0 ? 0 : static_cast<double>(differing) / compared;
  }
  /// The day on which it would have lost most, or gained least; null without days.
  [[nodiscard]] const ReplayedDay* worst_day() const;
};

/// Of the days from `first_day` to `last_day`, as 20231126; `power_w` is the battery's.
Replay replay_days(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                   std::int32_t power_w);

/// "2026-11-23 14:32 local  price 84.10 EUR/MWh, SoC 45.2 %: charge -> idle" of each that differs.
std::string replayed_cycles_text(const Replay& replay);
std::string replay_text(const Replay& replay);
Json replay_json(const Replay& replay);

}  // namespace bess
