// Controller log, one row per control cycle, as `bess-edge log --csv` prints it and `[log] csv`
// stores it; used by the battery fit (battery_fit.h) and the earnings (workstation/runs/log).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/action.h"

namespace bess {

struct LoggedCycle {
  std::int64_t utc_s = 0;
  double soc_frac = 0;
  double power_w = 0;    ///< measured before this tick's order; charge positive
  double ordered_w = 0;  ///< from this tick on
  bool is_cut = false;   ///< order reduced to the battery's reported limit
  bool has_reading = true;
  bool is_cycle = true;     ///< false: the controller stops without a decision
  bool is_driven = true;    ///< controlled by orders, 0 W included
  bool is_ordered = true;   ///< an order is in force, also one of a stop reason
  std::string reason = "";  ///< "student", or the reason that replaced its decision
  bool has_price = false;   ///< the next four fields are valid
  std::int64_t price_minute_utc_s = 0;
  double price_eur_per_mwh = 0;
  double decided_eur_per_mwh = 0;                  ///< price, or its stand-in if too old
  std::int32_t price_age_s = 0;                    ///< when the order was written
  bool is_price_usable = false;                    ///< recent enough, or with a stand-in
  std::optional<Action> student{};                 ///< decision before the guard; none: not asked
  std::int32_t level_centi = 0;                    ///< trailing price level, with `student`
  std::optional<std::int32_t> break_even_centi{};  ///< of the day's plan (outlook context)
};

struct CycleLog {
  std::vector<LoggedCycle> cycles;  ///< ascending, distinct times
  int torn = 0;                     ///< unfinished last lines after a power cut, skipped
  int duplicates = 0;               ///< rows with the time of another row, skipped
};

/// Joins several files into one log. Throws UserError naming file, line and column.
CycleLog read_cycle_log(const std::vector<std::string>& paths);

}  // namespace bess
