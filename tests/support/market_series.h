// Minute series for tests: flat, drawn from a seed, or the benchmark.
#pragma once

#include "shared/host/minute_file.h"
#include "shared/units_and_limits.h"
#include "tests/support/utc_of.h"
#include "workstation/base/random.h"

namespace bess {

inline MinuteSeries flat_series(std::string_view start_utc, int minutes, double price) {
  MinuteSeries series;
  series.start_utc_s = utc_of(start_utc);
  series.indicative.assign(static_cast<std::size_t>(minutes), price);
  series.settled = series.indicative;
  return series;
}

/// Settled prices are an autoregression over quarter-hours, indicative ones approach them within
/// the quarter-hour. Some prices are negative.
inline MinuteSeries random_series(std::string_view start_utc, int minutes, std::uint64_t seed) {
  MinuteSeries series = flat_series(start_utc, minutes, 0);
  Random random(seed);
  double settled = 100;
  for (std::size_t m = 0; m < series.size(); ++m) {
    const std::size_t minute_of_quarter_hour = m % kMinutesPerQuarterHour;
    if (minute_of_quarter_hour == 0) settled = 100 + 0.7 * (settled - 100) + 90 * random.normal();
    series.settled[m] = settled;
    const double left =
        1 - static_cast<double>(minute_of_quarter_hour + 1) / kMinutesPerQuarterHour;
    series.indicative[m] = settled + 60 * left * random.normal();
  }
  return series;
}

/// The benchmark [SPEC 8]: real settled quarter-hours of January to May 2023, see
/// tests/data/README.md.
inline MinuteSeries read_benchmark() {
  return read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
}

}  // namespace bess
