#include "workstation/data/market/model/simulated_market.h"

#include <algorithm>
#include <numeric>

#include "workstation/data/market/model/market_parameters.h"
#include "workstation/data/market/series/imbalance_price.h"

namespace bess {

double UnitAutoregression::next(Random& random) {
  const double shock = random.normal();
  value_ = started_ ? correlation_ * value_ + std::sqrt(1 - correlation_ * correlation_) * shock
                    : shock;  // starts in the stationary distribution: no warm-up days
  started_ = true;
  return value_;
}

MinutePathGenerator::MinutePathGenerator(std::uint64_t seed)
    : random_(seed), deviation_(kMinutePath.imbalance_correlation) {}

MinutePathGenerator::Path MinutePathGenerator::imbalance_path(double mean_mw) {
  Path instantaneous{};
  for (double& value : instantaneous) {
    value = kMinutePath.imbalance_deviation_mw * deviation_.next(random_);
  }
  const double mean =
      std::accumulate(instantaneous.begin(), instantaneous.end(), 0.0) / kMinutesPerQuarterHour;
  Path running{};
  double sum_mw = 0;
  for (int m = 0; m < kMinutesPerQuarterHour; ++m) {
    sum_mw += instantaneous[m] + mean_mw - mean;
    running[m] = sum_mw / (m + 1);
  }
  running.back() = mean_mw;  // rounding must not move a mean of 0 to the other side
  return running;
}

/// Monotone path to `final`: upwards for direction +1, downwards for -1. It starts at the previous
/// quarter-hour's price if that is on the path, else at a random gap from the end.
MinutePathGenerator::Path MinutePathGenerator::staircase(double previous, double final,
                                                         double direction) {
  const double gap_drawn = -kMinutePath.first_bid_gap_eur_per_mwh * std::log(1 - random_.uniform());
  const double gap = std::max((final - previous) * direction, gap_drawn) * direction;
  const double lateness = std::sqrt(std::sqrt(random_.uniform()));
  const int reached = static_cast<int>(kMinutePath.reach_minutes * lateness);
  Path path{};
  path.fill(final);
  double left = 1;  // remaining share of the gap
  for (int m = 0; m < reached; ++m) {
    path[m] = final - gap * left;
    if (random_.uniform() < kMinutePath.step_probability) left *= random_.uniform();
  }
  return path;
}

MinutePathGenerator::Sides MinutePathGenerator::final_sides(const QuarterHour& quarter_hour) const {
  Sides sides = previous_sides_;
  const double incremental = quarter_hour.marginal_incremental_eur_per_mwh;
  const double decremental = quarter_hour.marginal_decremental_eur_per_mwh;
  // A settled price without marginal prices is the marginal price of the active side.
  const bool shortage = is_short(quarter_hour.system_imbalance_mw);
  double& active = shortage ? sides.incremental : sides.decremental;
  active = quarter_hour.price_eur_per_mwh;
  if (is_published(incremental)) sides.incremental = incremental;
  if (is_published(decremental)) sides.decremental = decremental;
  return sides;
}

MinutePath MinutePathGenerator::draw(const QuarterHour& quarter_hour) {
  const double settled = quarter_hour.price_eur_per_mwh;
  const Sides sides = final_sides(quarter_hour);
  const Path imbalance = imbalance_path(quarter_hour.system_imbalance_mw);
  const Path incremental = staircase(previous_sides_.incremental, sides.incremental, +1);
  const Path decremental = staircase(previous_sides_.decremental, sides.decremental, -1);
  // Final difference to the formula: dead band and alpha' since 2024. Differences below a cent are
  // rounding.
  const double by_formula = imbalance_price_eur_per_mwh(
      {imbalance.back(), previous_imbalance_mw_, incremental.back(), decremental.back()});
  const double unexplained = in_cents(by_formula) == settled ? 0 : settled - by_formula;
  const MinutePath path{imbalance, incremental, decremental, previous_imbalance_mw_, unexplained};
  previous_sides_ = sides;
  previous_imbalance_mw_ = quarter_hour.system_imbalance_mw;
  return path;
}

MinutePrices MinutePathGenerator::next(const QuarterHour& quarter_hour) {
  const MinutePath path = draw(quarter_hour);
  MinutePrices prices{};
  for (int m = 0; m < kMinutesPerQuarterHour; ++m) {
    prices[m] = imbalance_price_eur_per_mwh(
        {path.imbalance_mw[m], m == 0 ? 0 : path.previous_imbalance_mw,
         path.incremental_eur_per_mwh[m], path.decremental_eur_per_mwh[m]});
    if (is_short(path.imbalance_mw[m]) == is_short(quarter_hour.system_imbalance_mw)) {
      prices[m] += path.unexplained_eur_per_mwh;
    }
  }
  prices.back() = quarter_hour.price_eur_per_mwh;
  return prices;
}

}  // namespace bess
