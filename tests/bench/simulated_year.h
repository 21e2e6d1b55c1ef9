// Simulated market year, made once for all benchmarks.
#pragma once

#include "workstation/data/env/market_steps.h"

namespace bess {

const MinuteSeries& year_of_minutes();
const MarketSteps& year_of_steps();

}  // namespace bess
