// ISO 8601 instants: formatting and parsing, without heap or locale.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string_view>

#include "shared/fixed_text.h"
#include "shared/local_time.h"

namespace bess {

using UtcText = FixedText<20>;

/// "2023-01-01T00:00:00Z".
inline UtcText utc_text(std::int64_t utc_s) {
  const CivilTime t = civil_from_utc(utc_s);
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, "%04d-%02d-%02dT%02d:%02d:%02dZ", t.year, t.month, t.day,
                t.hour, t.minute, t.second);
  return UtcText(buffer);
}

namespace detail {

/// Takes `count` digits off the front of `text`; -1 when they are not all digits.
constexpr int take_digits(std::string_view& text, std::size_t count) {
  if (text.size() < count) return -1;
  int value = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (text[i] < '0' || text[i] > '9') return -1;
    value = value * 10 + (text[i] - '0');
  }
  text.remove_prefix(count);
  return value;
}

constexpr bool take(std::string_view& text, char wanted) {
  if (text.empty() || text.front() != wanted) return false;
  text.remove_prefix(1);
  return true;
}

constexpr int days_in_month(int year, int month) {
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  const bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
  return month == 2 && leap ? 29 : kDays[month - 1];
}

/// "2026-11-23", a valid date.
constexpr bool take_date(std::string_view& text, CivilTime& t) {
  t.year = take_digits(text, 4);
  if (!take(text, '-')) return false;
  t.month = take_digits(text, 2);
  if (!take(text, '-')) return false;
  t.day = take_digits(text, 2);
  return t.year >= 1970 && t.month >= 1 && t.month <= 12 && t.day >= 1 &&
         t.day <= days_in_month(t.year, t.month);
}

/// "14:32".
constexpr bool take_clock(std::string_view& text, CivilTime& t) {
  t.hour = take_digits(text, 2);
  if (!take(text, ':')) return false;
  t.minute = take_digits(text, 2);
  return t.hour >= 0 && t.hour <= 23 && t.minute >= 0 && t.minute <= 59;
}

/// "Z", "+hh:mm" or "-hh:mm", and nothing after it.
constexpr bool take_offset(std::string_view& text, int& offset_s) {
  offset_s = 0;
  if (take(text, 'Z')) return text.empty();
  const bool negative = !text.empty() && text.front() == '-';
  if (!negative && (text.empty() || text.front() != '+')) return false;
  text.remove_prefix(1);
  const int hours = take_digits(text, 2);
  const bool colon = take(text, ':');
  const int minutes = take_digits(text, 2);
  if (!colon || hours < 0 || hours > 18 || minutes < 0 || minutes > 59 || !text.empty())
    return false;
  offset_s = (hours * 3'600 + minutes * 60) * (negative ? -1 : 1);
  return true;
}

}  // namespace detail

/// Separator of date and time: T, or a blank in input of other programs.
inline constexpr std::string_view kAlsoBlank = "T ";

/// Reads YYYY-MM-DDTHH:MM[:SS[.digits]] followed by Z or an offset; false if invalid. A time
/// without an offset is refused as ambiguous.
inline bool parse_utc(std::string_view text, std::int64_t& utc_s,
                      std::string_view separators = "T") {
  using namespace detail;
  CivilTime t{};
  if (!take_date(text, t)) return false;
  if (text.empty() || separators.find(text.front()) == separators.npos) return false;
  text.remove_prefix(1);
  if (!take_clock(text, t)) return false;
  if (take(text, ':')) {
    t.second = take_digits(text, 2);
    if (take(text, '.')) {
      if (take_digits(text, 1) < 0) return false;
      while (take_digits(text, 1) >= 0) continue;
    }
  }
  int offset_s = 0;
  if (!take_offset(text, offset_s)) return false;
  if (t.second < 0 || t.second > 59) return false;
  utc_s = utc_from_civil(t) - offset_s;
  return true;
}

}  // namespace bess
