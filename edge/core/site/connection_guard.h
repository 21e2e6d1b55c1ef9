// Connection limits for a battery behind the house meter: from measurements to the range of its
// order. Pure integers.
//
//   house = grid - battery, both measured         grid with an order = house + order
//   charge    <= import_w_max - margin - house     discharge <= export_w_max - margin + house
//
// The house is never limited: if its load alone exceeds a limit, the battery gets 0 W.
//
// Quarter-hour peak (the Belgian capacity tariff bills the highest mean import of a quarter-hour):
// with E imported so far, B of it taken by the battery, s seconds left and C = peak_w_max - margin,
//   E + (house + charge) s <= 900 C      the mean stays under the cap at constant house load
// If the house load rises so that E + house s > 900 C, the battery returns what it took in this
// quarter-hour (relief). A quarter-hour then ends above the cap only because of the house itself.
// The margin must cover a rise too late to respond to, and the losses of the returned energy. With
// `peak_shave` relief is not bounded by B: the house itself is kept under the cap.
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

#include "edge/core/base/status.h"
#include "edge/core/control/quarter_hour_energy.h"
#include "edge/core/control/site_types.h"
#include "shared/utc_text.h"

namespace bess {

// Outside limit, set by another program (a grid operator's device, a site controller): one line,
//   charge_w discharge_w utc_until      e.g.  0 any 2026-11-22T10:15:00Z
// in W, 0 or more, or `any`. It expires at its time. Pure parsing; limit_file reads it.

struct OutsideLimit {
  std::int32_t charge_w_max = kAnyPowerW;
  std::int32_t discharge_w_max = kAnyPowerW;
  std::int64_t until_utc_s = 0;  ///< in force before this instant
};

inline constexpr std::string_view kAnyPowerText = "any";

/// Longest valid line, including its end of line.
inline constexpr std::size_t kLimitBytesMax = 64;

inline bool parse_limit_power(std::string_view text, std::int32_t& power_w) {
  if (text == kAnyPowerText) {
    power_w = kAnyPowerW;
    return true;
  }
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), power_w);
  return error == std::errc{} && end == text.data() + text.size() && power_w >= 0;
}

/// Removes the first word and its blank from `text`; false without a blank.
inline bool take_word(std::string_view& text, std::string_view& word) {
  const std::size_t size = text.find(' ');
  if (size == text.npos) return false;
  word = {text.data(), size};
  text.remove_prefix(size + 1);
  return true;
}

/// kMalformed unless the whole text is one line with its end of line: a truncated file must not be
/// read as a smaller number.
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

struct ConnectionSettings {
  std::int32_t import_w_max = kAnyPowerW;
  std::int32_t export_w_max = kAnyPowerW;
  std::int32_t peak_w_max = kAnyPowerW;  ///< mean of a quarter-hour
  std::int32_t margin_w = 200;           ///< kept free below each of the three
  bool peak_shave = false;
};

struct ConnectionState {
  std::int32_t grid_w = 0;
  std::int32_t battery_w = 0;
  QuarterHourEnergy::Sums quarter_hour{};
};

/// Narrows `range` to the limits of the connection, keeping `margin_w` free.
void limit_at_connection(const ConnectionSettings& settings, std::int32_t margin_w,
                         const ConnectionState& state, SiteRange& range);

}  // namespace bess
