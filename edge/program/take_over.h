// What a run takes over from the newest record of the run before, which is empty where there is none.
#pragma once

#include "edge/control/control_loop.h"

namespace bess {

inline TakeOver take_over_of(const CycleRecord& before, const PriceLevel& level,
                             bool is_trip_cleared) {
  return {.throughput = before.throughput,
          .price_level = level,
          .trip = before.is_tripped && !is_trip_cleared ? before.trip : Trip{},
          .lost_orders = before.lost_orders,
          .reversals = before.reversals,
          .last_full_day = last_full_day_of(before.utc_s, before.days_since_full),
          .site = before.site,
          .standing_price = before.standing_price,
          .utc_s = before.utc_s};
}

}  // namespace bess
