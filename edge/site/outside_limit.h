// A limit that another program sets (a grid operator's box, a site controller): one line of text,
//   charge_w discharge_w utc_until      e.g.  0 any 2026-11-22T10:15:00Z
// in W, 0 or more, or `any`. It ends by itself at its time. Pure parsing; limit_file reads it.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

#include "edge/base/status.h"
#include "edge/control/site_types.h"
#include "shared/utc_text.h"

namespace bess {

struct OutsideLimit {
  std::int32_t charge_w_max = kAnyPowerW;
  std::int32_t discharge_w_max = kAnyPowerW;
  std::int64_t until_utc_s = 0;  ///< in force before this instant
};

inline constexpr std::string_view kAnyPowerText = "any";

/// Longest line that can be one, its end of line included.
inline constexpr std::size_t kLimitBytesMax = 64;

inline bool parse_limit_power(std::string_view text, std::int32_t& power_w) {
  if (text == kAnyPowerText) {
    power_w = kAnyPowerW;
    return true;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), power_w);
  return error == std::errc{} && end == text.data() + text.size() && power_w >= 0;
}

/// Takes the word before the next blank off the front of `text`, and the blank; false without one.
inline bool take_word(std::string_view& text, std::string_view& word) {
  const std::size_t size = text.find(' ');
  if (size == text.npos) return false;
  word = {text.data(), size};
  text.remove_prefix(size + 1);
  return true;
}

/// kMalformed unless the whole text is that one line with its end of line: a file that was cut
/// short must not be taken for a smaller number.
inline Status parse_outside_limit(std::string_view text, OutsideLimit& limit) {
  limit = OutsideLimit{};
  if (!text.ends_with('\n')) return Status::kMalformed;
  text.remove_suffix(1);
  std::string_view charge, discharge;
  const bool is_good = take_word(text, charge) && take_word(text, discharge) &&
                       parse_limit_power(charge, limit.charge_w_max) &&
                       parse_limit_power(discharge, limit.discharge_w_max) &&
                       parse_utc(text, limit.until_utc_s);
  return is_good ? Status::kOk : Status::kMalformed;
}

}  // namespace bess
