// Simulated market with its published day-ahead prices.
#pragma once

#include <memory>

#include "workstation/data/env/market_steps.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

struct OutlookMarket {
  MinuteSeries minutes;
  DayAheadSeries day_ahead;

  [[nodiscard]] MarketSteps steps(int published_min = kDayAheadPublishedMin) const {
    return steps_with(day_ahead, published_min);
  }
  [[nodiscard]] MarketSteps steps_with(const DayAheadSeries& other,
                                       int published_min = kDayAheadPublishedMin) const {
    MarketSteps market = make_market_steps(minutes, {});
    attach_day_ahead(market, std::make_shared<DayAheadPublication>(other, published_min));
    return market;
  }
};

/// From a local day on, drawn from a seed.
inline OutlookMarket outlook_market(const LocalDate& start, int days, std::uint64_t seed = 2) {
  const auto quarter_hours = simulate_quarter_hours(
      {local_midnight_utc_s(start), local_midnight_utc_s(add_days(start, days))}, seed);
  return {minutes_on_quarter_hours(quarter_hours, seed), simulate_day_ahead(quarter_hours, seed)};
}

}  // namespace bess
