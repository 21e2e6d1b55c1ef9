#include "edge/core/control/outlook.h"

#include "shared/local_time.h"

namespace bess {
namespace {

std::int32_t distance(std::int32_t a, std::int32_t b) { return a < b ? b - a : a - b; }

int nearest_level(const OutlookPlanRows& plan_rows, std::int32_t level_centi) {
  int nearest = 0;
  for (int i = 1; i < plan_rows.levels; ++i) {
    const bool is_nearer = distance(plan_rows.level_centi[i], level_centi) <
                           distance(plan_rows.level_centi[nearest], level_centi);
    if (is_nearer) nearest = i;
  }
  return nearest;
}

OutlookSource source_of(const OutlookPlanRows& plan_rows, std::int64_t tick_utc_s,
                        bool is_exact_level) {
  if (plan_rows.first_tick_utc_s != tick_utc_s || !is_exact_level) return OutlookSource::kLate;
  return plan_rows.is_published ? OutlookSource::kPlanned : OutlookSource::kUsual;
}

}  // namespace

OutlookReport outlook_at(const OutlookExchange& exchange, std::int64_t tick_utc_s,
                         std::int32_t soc_e4, std::int32_t level_centi) {
  const OutlookPlanRows& plan_rows = exchange.plan_rows;
  const std::int64_t ahead_s = tick_utc_s - plan_rows.first_tick_utc_s;
  const std::int64_t tick = ahead_s / kSecondsPerStep;
  if (ahead_s < 0 || ahead_s % kSecondsPerStep != 0 || tick >= plan_rows.ticks) {
    const BreakEvenRow& row = exchange.usual.rows[local_minute_of(tick_utc_s).quarter_hour];
    return {.source = OutlookSource::kMissing,
            .break_even_centi =
                row.at(*exchange.model, soc_e4, level_centi, exchange.usual.level_centi)};
  }
  const std::int32_t wanted_centi = planned_level_centi(level_centi);
  const int i = nearest_level(plan_rows, wanted_centi);
  return {.source = source_of(plan_rows, tick_utc_s, plan_rows.level_centi[i] == wanted_centi),
          .break_even_centi = plan_rows.rows[i][tick].at(*exchange.model, soc_e4, level_centi,
                                                         plan_rows.level_centi[i]),
          .known_quarter_hours = plan_rows.known_quarter_hours,
          .dearest = plan_rows.dearest,
          .cheapest = plan_rows.cheapest,
          .feed = plan_rows.feed};
}

}  // namespace bess
