// Gaps: time intervals without a price.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct Gap {
  std::int64_t from_utc_s;
  std::int64_t until_utc_s;  ///< exclusive
};

/// Intervals of NaN in a series with one value every `step_s` seconds.
std::vector<Gap> gaps_in(std::span<const double> values, std::int64_t start_utc_s,
                         std::int64_t step_s);
std::int64_t minutes_in(const std::vector<Gap>& gaps);

/// "settled price: 3 gaps, 45 minutes missing" and the longest of them, one per line.
std::string describe_gaps(std::string_view what, std::vector<Gap> gaps);

}  // namespace bess
