#include "edge/fetch/outlook_planner.h"

#include <algorithm>

#include "shared/local_time.h"
#include "shared/price_level.h"

namespace bess {
namespace {

/// What one decision can move the trailing level by, and a cent for rounding.
constexpr std::int32_t kLevelMoveMaxCenti =
    (PriceLevel::kMaxCenti - PriceLevel::kMinCenti) / static_cast<int>(PriceLevel::kDecisions) + 2;
static_assert(kLevelMoveMaxCenti < kPlannedLevelCenti, "two plans would not suffice");

/// What is published from the tick's quarter-hour on.
void describe(const OutlookDays& days, std::int64_t tick_utc_s, OutlookOffer& offer) {
  const std::int64_t now = tick_utc_s - tick_utc_s % kSecondsPerQuarterHour;
  offer.is_published = days.day_ahead_centi[days.index_of(now)] != kDayAheadUnknown;
  offer.known_quarter_hours = 0;
  offer.dearest = offer.cheapest = {};
  for (std::int64_t t = now; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const std::int32_t centi = days.day_ahead_centi[days.index_of(t)];
    if (centi == kDayAheadUnknown) continue;
    const bool is_first = offer.known_quarter_hours++ == 0;
    if (is_first || centi > offer.dearest.centi_eur_per_mwh) offer.dearest = {t, centi};
    if (is_first || centi < offer.cheapest.centi_eur_per_mwh) offer.cheapest = {t, centi};
  }
}

}  // namespace

OutlookPlanner::OutlookPlanner(const OutlookModel& model, OutlookBoard& board)
    : model_(model), board_(board) {
  board.model = &model;
}

/// An hour that the clock leaves out has the row of the one before it.
void OutlookPlanner::plan_usual_day(std::int64_t utc_s, std::int32_t level_centi) {
  const OutlookDays days = outlook_days_around(utc_s);
  const Made& made = plan_of(days, planned_level_centi(level_centi), nullptr);
  UsualDay& usual = board_.usual;
  usual.level_centi = made.level_centi;
  int quarter_hour = 0;
  for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerQuarterHour) {
    const int now = local_minute_of(t).quarter_hour;
    const BreakEvenRow& row = made.plan.row_at(t);
    while (quarter_hour < now) usual.rows[quarter_hour++] = row;
    usual.rows[now] = row;
    quarter_hour = std::max(quarter_hour, now + 1);
  }
}

const OutlookPlanner::Made& OutlookPlanner::plan_of(const OutlookDays& days,
                                                    std::int32_t level_centi, const Made* needed) {
  for (const Made& made : made_) {
    if (made.is_of(days, level_centi)) return made;
  }
  Made& place = &made_[0] == needed ? made_[1] : made_[0];
  place.plan.make(model_, days, level_centi);
  place.days = days;
  place.level_centi = level_centi;
  place.is_made = true;
  ++plans_made_;
  return place;
}

int OutlookPlanner::plan(const Wanted& wanted, const OutlookDays& days) {
  const int made_before = plans_made_;
  const std::int64_t tick_utc_s = wanted.tick_utc_s;
  OutlookOffer& offer = board_.offers.draft();
  offer.first_tick_utc_s = tick_utc_s;
  offer.feed = wanted.feed;
  const std::int64_t left = (days.tomorrow_utc_s - tick_utc_s) / kSecondsPerStep;
  offer.ticks = static_cast<int>(std::min<std::int64_t>(left, OutlookOffer::kTicks));
  const std::int32_t low_centi = planned_level_centi(wanted.level_centi - kLevelMoveMaxCenti);
  const std::int32_t high_centi = planned_level_centi(wanted.level_centi + kLevelMoveMaxCenti);
  const Made* needed = nullptr;
  for (const Made& made : made_) {  // of two that are needed, none may go for the other
    if (made.is_of(days, high_centi)) needed = &made;
  }
  offer.levels = low_centi == high_centi ? 1 : 2;
  for (int i = 0; i < offer.levels; ++i) {
    const Made& made = plan_of(days, i == 0 ? low_centi : high_centi, needed);
    needed = &made;
    offer.level_centi[i] = made.level_centi;
    for (int tick = 0; tick < offer.ticks; ++tick) {
      offer.rows[i][tick] = made.plan.row_at(tick_utc_s + tick * kSecondsPerStep);
    }
  }
  describe(days, tick_utc_s, offer);
  board_.offers.post();
  return plans_made_ - made_before;
}

}  // namespace bess
