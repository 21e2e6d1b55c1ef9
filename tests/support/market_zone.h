// Base of tests whose members are instants of local time: it sets the zone before they are made.
#pragma once

#include "shared/local_time.h"

namespace bess {

struct InMarketZone {
  InMarketZone() { set_market_time_zone(); }
};

}  // namespace bess
