#include "tests/bench/simulated_year.h"

#include "shared/local_time.h"
#include "workstation/data/market/model/simulated_market.h"

namespace bess {
namespace {

constexpr std::uint64_t kSeed = 1;

}  // namespace

const MinuteSeries& year_of_minutes() {
  static const MinuteSeries series = [] {
    const std::int64_t start = utc_from_civil({2023, 1, 1, 0, 0, 0}) - 3600;
    const UtcSpan period{start, start + std::int64_t{365} * 86'400};
    return minutes_on_quarter_hours(simulate_quarter_hours(period, kSeed), kSeed);
  }();
  return series;
}

const MarketSteps& year_of_steps() {
  static const MarketSteps market = make_market_steps(year_of_minutes(), {});
  return market;
}

}  // namespace bess
