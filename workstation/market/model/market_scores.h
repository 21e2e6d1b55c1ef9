// The random drivers of the simulated market: three scores a quarter-hour, whose ranks pick the
// rungs of the ladders. A score is an expectation from the calendar plus autoregressive noise.
#pragma once

#include <array>
#include <cstdint>

#include "workstation/market/model/market_parameters.h"
#include "workstation/market/model/minute_path.h"

namespace bess {

/// What the calendar says about a quarter-hour, in the market's local time.
struct MarketCalendar {
  double hour;    ///< 0..24
  double winter;  ///< 1 in mid January, -1 in mid July
  bool weekend;
};

/// Needs the market's time zone (set_market_time_zone).
MarketCalendar market_calendar_of(std::int64_t utc_s);

class ScoreProcess {
 public:
  explicit ScoreProcess(const ScoreParameters& parameters);
  /// Score of the next quarter-hour.
  double next(const MarketCalendar& calendar, Random& random);

 private:
  const ScoreParameters& parameters_;
  std::array<UnitAutoregression, 3> parts_;
};

}  // namespace bess
