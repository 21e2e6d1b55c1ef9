// Plans for the ticks ahead, from what is known of day-ahead prices at the next of them, and offers
// their rows to the control thread (control/outlook.h). Never in a hurry: the next decision's level
// lies within one decision's move of the last one's, so that the plans of at most two levels are
// needed, and those of the tick before mostly serve. Nothing is allocated; one thread at a time.
#pragma once

#include <cstdint>

#include "edge/control/outlook.h"
#include "edge/fetch/day_ahead_book.h"

namespace bess {

class OutlookPlanner {
 public:
  OutlookPlanner(const OutlookModel& model, OutlookBoard& board);

  /// The day without day-ahead prices, for when nothing else is there. Before the loop starts.
  void plan_usual_day(std::int64_t utc_s, std::int32_t level_centi);
  struct Wanted {
    std::int64_t tick_utc_s = 0;
    std::int32_t level_centi = 0;  ///< of the decision before it
    Status feed = Status::kOk;     ///< how day-ahead prices were last answered
  };
  /// Offers the rows from a tick on. `days`: what is known at it. Returns how many plans had to be
  /// made for it.
  int plan(const Wanted& wanted, const OutlookDays& days);

 private:
  struct Made {
    OutlookPlan plan;
    OutlookDays days;
    std::int32_t level_centi = 0;
    bool is_made = false;
    [[nodiscard]] bool is_of(const OutlookDays& other_days, std::int32_t other_level_centi) const {
      return is_made && level_centi == other_level_centi && days == other_days;
    }
  };

  /// The plan of a level; one that is not `needed` gives its place to a new one.
  const Made& plan_of(const OutlookDays& days, std::int32_t level_centi, const Made* needed);

  const OutlookModel& model_;
  OutlookBoard& board_;
  Made made_[OutlookOffer::kLevels] = {};
  int plans_made_ = 0;
};

}  // namespace bess
