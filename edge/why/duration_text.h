// How long something holds, as a person writes it: 90s, 15m, 2h, 1d12h.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

namespace bess {

/// Seconds of whole numbers, each with s, m, h or d behind it; false when it is none, 0, or more
/// than a week.
inline bool parse_duration(std::string_view text, std::int64_t& seconds) {
  constexpr std::int64_t kWeekS = 7 * 86'400;
  constexpr std::string_view kUnits = "smhd";
  constexpr std::int64_t kUnitSeconds[] = {1, 60, 3'600, 86'400};
  seconds = 0;
  while (!text.empty()) {
    std::int32_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || count < 0 || end == text.data() + text.size()) return false;
    const std::size_t unit = kUnits.find(*end);
    if (unit == kUnits.npos) return false;
    seconds += count * kUnitSeconds[unit];
    if (seconds > kWeekS) return false;
    text.remove_prefix(static_cast<std::size_t>(end + 1 - text.data()));
  }
  return seconds > 0;
}

}  // namespace bess
