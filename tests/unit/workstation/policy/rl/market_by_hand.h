// Two small markets: one by hand, with a distinct price for every step, and one simulated.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "shared/battery_model.h"
#include "shared/crc32.h"
#include "shared/local_time.h"
#include "tests/support/user_error_of.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/policy.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

/// A day of the market by hand: its split and the start of each step, in steps since the first.
struct DayByHand {
  Split split;
  std::vector<int> starts;
};

/// Step k observes 10 k EUR/MWh and is paid 100 + k.
inline MarketSteps market_by_hand(const std::vector<DayByHand>& days) {
  MarketSteps market;
  for (std::size_t d = 0; d < days.size(); ++d) {
    market.days.push_back({2023, 1, static_cast<int>(d) + 1, days[d].split, market.steps.size(),
                           days[d].starts.size()});
    for (const int start : days[d].starts) {
      const auto k = static_cast<double>(market.steps.size());
      MarketStep step{};
      step.utc_s = std::int64_t{start} * kSecondsPerStep;
      step.observed_eur_per_mwh = 10 * k;
      step.paid_eur_per_mwh = 100 + k;
      step.minute_of_quarter_hour = static_cast<std::int8_t>(2 * start % 15);
      step.quarter_hour = static_cast<std::int8_t>(40 + start);
      step.month = 6;
      market.steps.push_back(step);
    }
  }
  return market;
}

/// Consecutive training days that end at a validation day, a missing day and a gap.
inline MarketSteps uneven_market() {
  return market_by_hand({{Split::kTrain, {0, 1, 2, 3}},         // steps 0..3, next day follows
                         {Split::kTrain, {4, 5, 6, 7}},         // steps 4..7, then validation
                         {Split::kValidation, {8, 9, 10, 11}},  // steps 8..11
                         {Split::kTrain, {12, 13, 14, 15}},     // steps 12..15, then nothing
                         {Split::kTrain, {20, 21, 23, 24}},     // steps 16..19, with a gap
                         {Split::kTest, {25, 26, 27, 28}}});    // steps 20..23
}

/// Straight line over the lattice: the price of every step is distinct.
inline PriceMap straight_price_map() {
  return PriceMap::fit({double{kLatticePriceMinEurPerMwh}, double{kLatticePriceMaxEurPerMwh}});
}

/// Step whose observed price the network input shows.
inline int step_of_input(float price_input) {
  const double price = kLatticePriceMinEurPerMwh + double{price_input} * (kPriceCount - 1);
  return static_cast<int>(std::lround(price / 10));
}

/// On a path through the steps; at full and empty two actions have identical values.
inline void expect_same_decisions(const Policy& a, const Policy& b,
                                  std::span<const MarketStep> steps) {
  const BatteryParameters battery;
  double soc_frac = 0.5;
  for (const MarketStep& step : steps) {
    for (const double soc : {soc_frac, battery.soc_min_frac, battery.soc_max_frac}) {
      ASSERT_EQ(a.decide(step, 0, soc), b.decide(step, 0, soc)) << step.utc_s;
    }
    const double ordered_w = power_sign(a.decide(step, 0, soc_frac)) * battery.power_w_max;
    soc_frac = battery_step(battery, soc_frac, ordered_w, kHoursPerStep).soc_frac;
  }
}

/// The bytes of a teacher's file under a valid checksum.
inline std::string resealed(std::string bytes) {
  bytes.resize(bytes.size() - sizeof(std::uint32_t));
  Crc32 crc;
  crc.add_bytes(bytes.data(), bytes.size());
  const std::uint32_t checksum = crc.value();
  return bytes.append(reinterpret_cast<const char*>(&checksum), sizeof checksum);
}

inline MarketSteps simulated_market(const LocalDate& first, int days) {
  set_market_time_zone();
  const UtcSpan period{local_midnight_utc_s(first), local_midnight_utc_s(add_days(first, days))};
  return make_market_steps(minutes_on_quarter_hours(simulate_quarter_hours(period, 5), 5), {});
}

}  // namespace bess
