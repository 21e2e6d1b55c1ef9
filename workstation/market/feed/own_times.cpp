#include "workstation/market/feed/own_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kHour_s = 3'600;

/// "1/6/2025 9:15" by "dd/mm/yyyy" as "2025-06-01 09:15"; empty when it is otherwise.
std::string iso_text(std::string_view text, std::string_view format) {
  int year = 0, month = 0, day = 0;
  while (!format.empty()) {
    const char kind = format.front();
    const std::size_t width = std::min(format.find_first_not_of(kind), format.size());
    format.remove_prefix(width);
    if (kind != 'y' && kind != 'm' && kind != 'd') {
      if (!detail::take(text, kind)) return {};
      continue;
    }
    int& part = kind == 'y' ? year : kind == 'm' ? month : day;
    const char* const last = text.data() + std::min(width, text.size());
    const auto taken =
        static_cast<std::size_t>(std::from_chars(text.data(), last, part).ptr - text.data());
    if (taken == 0 || (kind == 'y' && taken < width)) return {};
    text.remove_prefix(taken);
  }
  const bool has_short_hour = text.size() > 2 && text[2] == ':';
  return fmt::format("{:04}-{:02}-{:02}{}{}{}", year, month, day, text.substr(0, 1),
                     has_short_hour ? "0" : "", text.substr(std::min<std::size_t>(1, text.size())));
}

bool shows(std::int64_t utc_s, std::int64_t wall_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const CivilTime wall = civil_from_utc(wall_s);
  return local.day == wall.day && local.minute_of_day == wall.hour * 60 + wall.minute;
}

struct Instant {
  std::int64_t utc_s;
  bool comes_twice = false;  ///< the clock shows it again an hour later
};

[[noreturn]] void refuse(const TextLine& of, std::string_view name, std::string_view why) {
  fail("{}:{}: \"{}\" {}", name, of.number, one_line(of.text, 40), why);
}

Instant instant_of(const TextLine& of, std::string_view name, const OwnTimes& form) {
  const std::string text = iso_text(of.text, form.date_format);
  Instant instant{};
  if (parse_utc(text, instant.utc_s, kAlsoBlank)) return instant;
  if (!parse_utc(text + "Z", instant.utc_s, kAlsoBlank)) {
    refuse(of, name,
           fmt::format("is not a time as {} hh:mm; 'prices import --date-format' names another "
                       "order of day and month, dd/mm/yyyy or mm/dd/yyyy",
                       form.date_format));
  }
  if (!form.clock) {
    refuse(of, name,
           "is not a time with its UTC offset, e.g. 2023-01-31T00:15:00+01:00: say 'prices import "
           "--time-zone utc', or --time-zone local for Belgian clocks");
  }
  if (*form.clock == WallClock::kUtc) return instant;
  const std::int64_t wall_s = instant.utc_s;
  instant.utc_s = utc_from_local(civil_from_utc(wall_s)) + wall_s % 60;
  if (!shows(instant.utc_s, wall_s)) {
    refuse(of, name, "is left out by Belgian clocks, which go forward that night: are they UTC?");
  }
  instant.comes_twice = shows(instant.utc_s + kHour_s, wall_s);
  return instant;
}

/// Of an hour that comes twice each time must stand twice, the one pass before the other.
void part_hours(std::vector<Instant>& instants, const std::vector<TextLine>& texts,
                std::string_view name) {
  std::map<std::int64_t, std::vector<std::size_t>> rows_of;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (instants[i].comes_twice) rows_of[instants[i].utc_s].push_back(i);
  }
  if (rows_of.empty()) return;
  const bool newest_first = instants.front().utc_s > instants.back().utc_s;
  constexpr const char* kDoubt =
      "is shown twice by Belgian clocks, which go back that night, and the rows do not tell which "
      "is meant: write the times of this hour with their UTC offset";
  for (const auto& [utc_s, rows] : rows_of) {
    if (rows.size() != 2) refuse(texts[rows.back()], name, kDoubt);
    instants[rows[newest_first ? 0 : 1]].utc_s += kHour_s;
  }
  std::optional<std::int64_t> before;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (!instants[i].comes_twice) continue;
    if (before && (*before > instants[i].utc_s) != newest_first) refuse(texts[i], name, kDoubt);
    before = instants[i].utc_s;
  }
}

}  // namespace

std::vector<std::int64_t> read_times(const std::vector<TextLine>& texts, std::string_view name,
                                     const OwnTimes& form) {
  std::vector<Instant> instants;
  for (const TextLine& text : texts) instants.push_back(instant_of(text, name, form));
  part_hours(instants, texts, name);
  std::vector<std::int64_t> utc_s;
  for (const Instant& instant : instants) utc_s.push_back(instant.utc_s);
  return utc_s;
}

std::int64_t step_of_times(std::vector<std::int64_t> utc_s, std::string_view name) {
  std::ranges::sort(utc_s);
  std::map<std::int64_t, std::size_t> count_of;
  for (std::size_t i = 1; i < utc_s.size(); ++i) {
    if (utc_s[i] != utc_s[i - 1]) ++count_of[utc_s[i] - utc_s[i - 1]];
  }
  if (count_of.empty()) return kSecondsPerQuarterHour;
  const std::int64_t step_s =
      std::ranges::max_element(count_of, {}, [](const auto& of) { return of.second; })->first;
  if (step_s == 60 || step_s == kSecondsPerQuarterHour) return step_s;
  fail(
      "{}: a price every {:g} minutes; imbalance prices come every minute or every quarter-hour: "
      "get those (hours are day-ahead prices: prices import --day-ahead)",
      name, static_cast<double>(step_s) / 60);
}

}  // namespace bess
