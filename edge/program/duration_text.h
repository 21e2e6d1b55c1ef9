// How long something holds, as a person writes it: 90s, 15m, 2h.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

namespace bess {

/// Seconds of a whole number above 0 with its unit; false when it is none, or more than a week.
inline bool parse_duration(std::string_view text, std::int64_t& seconds) {
  constexpr std::int64_t kWeekS = 7 * 86'400;
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end + 1 != text.data() + text.size()) return false;
  const std::int64_t unit_s = *end == 's' ? 1 : *end == 'm' ? 60 : *end == 'h' ? 3'600 : 0;
  if (unit_s == 0 || number <= 0 || number > kWeekS / unit_s) return false;
  seconds = number * unit_s;
  return true;
}

}  // namespace bess
