// Two months of minutes from a seed: quarter-hour prices that persist and spike, minutes that
// converge to them. Small enough for every test, with training, validation and test days.
#pragma once

#include <cmath>

#include "shared/host/minute_file.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "workstation/base/random.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

inline MinuteSeries small_series(int days = 59, std::uint64_t seed = 7) {
  set_market_time_zone();
  MinuteSeries series;
  parse_utc("2022-12-31T23:00:00Z", series.start_utc_s);
  Random random(seed);
  double deviation = 0;
  for (int q = 0; q < days * 96; ++q) {
    deviation = 0.7 * deviation + 90 * random.normal();
    const double price = 100 + 40 * std::sin(q % 96 / 96.0 * 6.28) + deviation;
    for (int m = 0; m < 15; ++m) {
      series.settled.push_back(price);
      series.indicative.push_back(price + random.normal() * 60 / (1 + m));
    }
  }
  return series;
}

/// The two months as decisions, made once.
inline const MarketSteps& small_steps() {
  static const MarketSteps steps = make_market_steps(small_series(), {});
  return steps;
}

inline MinuteSeries constant_series(double price, int days = 28) {
  MinuteSeries series = small_series(days);
  for (double& p : series.settled) p = price;
  for (double& p : series.indicative) p = price;
  return series;
}

}  // namespace bess
