#include "edge/core/control/outlook.h"

#include "shared/local_time.h"

namespace bess {
namespace {

std::int32_t distance(std::int32_t a, std::int32_t b) { return a < b ? b - a : a - b; }

int nearest_level(const OutlookOffer& offer, std::int32_t level_centi) {
  int nearest = 0;
  for (int i = 1; i < offer.levels; ++i) {
    const bool is_nearer = distance(offer.level_centi[i], level_centi) <
                           distance(offer.level_centi[nearest], level_centi);
    if (is_nearer) nearest = i;
  }
  return nearest;
}

OutlookSource source_of(const OutlookOffer& offer, std::int64_t tick_utc_s, bool is_exact_level) {
  if (offer.first_tick_utc_s != tick_utc_s || !is_exact_level) return OutlookSource::kLate;
  return offer.is_published ? OutlookSource::kPlanned : OutlookSource::kUsual;
}

}  // namespace

OutlookReport outlook_at(OutlookBoard& board, std::int64_t tick_utc_s, std::int32_t soc_e4,
                         std::int32_t level_centi) {
  const OutlookOffer& offer = board.offers.latest();
  const std::int64_t ahead_s = tick_utc_s - offer.first_tick_utc_s;
  const std::int64_t tick = ahead_s / kSecondsPerStep;
  if (ahead_s < 0 || ahead_s % kSecondsPerStep != 0 || tick >= offer.ticks) {
    const BreakEvenRow& row = board.usual.rows[local_minute_of(tick_utc_s).quarter_hour];
    return {.source = OutlookSource::kMissing,
            .break_even_centi = row.at(*board.model, soc_e4, level_centi, board.usual.level_centi)};
  }
  const std::int32_t wanted_centi = planned_level_centi(level_centi);
  const int i = nearest_level(offer, wanted_centi);
  return {.source = source_of(offer, tick_utc_s, offer.level_centi[i] == wanted_centi),
          .break_even_centi =
              offer.rows[i][tick].at(*board.model, soc_e4, level_centi, offer.level_centi[i]),
          .known_quarter_hours = offer.known_quarter_hours,
          .dearest = offer.dearest,
          .cheapest = offer.cheapest,
          .feed = offer.feed};
}

}  // namespace bess
