// Local days as a person asks for them: today, yesterday, week, month, last-month, 2026-11,
// 2026-11-23, 2026-11-01..2026-11-23.
#pragma once

#include <cstdint>
#include <string_view>

namespace bess {

/// Both ends belong to it; days as 20231126.
struct Period {
  std::int32_t first_day = 0;
  std::int32_t last_day = 0;
  friend constexpr bool operator==(const Period&, const Period&) = default;
};

/// A week begins on Monday; week and month end today. False when it is none of these, or ends
/// before it begins.
bool parse_period(std::string_view text, std::int32_t today, Period& period);

}  // namespace bess
