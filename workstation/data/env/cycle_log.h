// The log of a controller, a row a cycle, as `bess-edge log --csv` prints it and `[log] csv` keeps
// it: read once, for what a battery really does (battery_fit.h) and for what it earned
// (workstation/runs/log).
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
  double power_w = 0;    ///< measured at the tick, before its order; charge positive
  double ordered_w = 0;  ///< from this tick on
  bool is_cut = false;   ///< that order, to what the battery said it could
  bool has_reading = true;
  bool is_cycle = true;     ///< false: the controller stops, and decides nothing
  bool is_driven = true;    ///< the battery follows orders, 0 W included
  bool is_ordered = true;   ///< an order was written and is in force, of a stop reason's too
  std::string reason = "";  ///< who decided: "student", or what stood above it
  bool has_price = false;   ///< the four below
  std::int64_t price_minute_utc_s = 0;
  double price_eur_per_mwh = 0;
  double decided_eur_per_mwh = 0;   ///< what stood in for a price that is too old, else the price
  std::int32_t price_age_s = 0;     ///< when the order was written
  bool is_price_usable = false;     ///< young enough, or something stands in for it
  std::optional<Action> student{};  ///< what it decided, before the guard; none: not asked
  std::int32_t level_centi = 0;     ///< trailing price level, with `student`
  std::optional<std::int32_t> break_even_centi{};  ///< of the day's plan, by outlook
};

struct CycleLog {
  std::vector<LoggedCycle> cycles;  ///< oldest first, each time once
  int torn = 0;                     ///< last lines that a power cut left unfinished: passed over
  int duplicates = 0;               ///< rows of a time that there is already: passed over
};

/// Several files are one log. Throws UserError naming file, line and column.
CycleLog read_cycle_log(const std::vector<std::string>& paths);

}  // namespace bess
