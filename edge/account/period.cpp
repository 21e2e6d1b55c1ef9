#include "edge/account/period.h"

#include <chrono>
#include <string>

#include "shared/utc_text.h"

namespace bess {
namespace {

using Days = std::chrono::sys_days;

Days days_of(std::int32_t day) {
  using namespace std::chrono;
  return year{day / 10'000} / month{static_cast<unsigned>(day / 100 % 100)} /
         std::chrono::day{static_cast<unsigned>(day % 100)};
}

std::int32_t day_of(Days days) {
  const std::chrono::year_month_day date{days};
  return static_cast<int>(date.year()) * 10'000 +
         static_cast<int>(static_cast<unsigned>(date.month())) * 100 +
         static_cast<int>(static_cast<unsigned>(date.day()));
}

/// From its first day to its last.
Period month_of(std::int32_t day) {
  using namespace std::chrono;
  const year_month month =
      year{day / 10'000} / std::chrono::month{static_cast<unsigned>(day / 100 % 100)};
  return {day / 100 * 100 + 1, day_of(Days{month / last})};
}

/// "2026-11" and nothing else.
bool parse_month(std::string_view text, Period& period) {
  const std::string whole = std::string(text) + "-01";
  std::string_view rest = whole;
  CivilTime date{};
  if (text.size() != 7 || !detail::take_date(rest, date) || !rest.empty()) return false;
  period = month_of(date.year * 10'000 + date.month * 100 + 1);
  return true;
}

/// "2026-11-23" and nothing else.
bool parse_date(std::string_view text, std::int32_t& day) {
  CivilTime date{};
  if (!detail::take_date(text, date) || !text.empty()) return false;
  day = date.year * 10'000 + date.month * 100 + date.day;
  return true;
}

}  // namespace

bool parse_period(std::string_view text, std::int32_t today, Period& period) {
  using std::chrono::days;
  const Days now = days_of(today);
  if (text == "today") {
    period = {today, today};
    return true;
  }
  if (text == "yesterday") {
    period = {day_of(now - days{1}), day_of(now - days{1})};
    return true;
  }
  if (text == "week") {
    const days since_monday = std::chrono::weekday{now} - std::chrono::Monday;
    period = {day_of(now - since_monday), today};
    return true;
  }
  if (text == "month") {
    period = {today / 100 * 100 + 1, today};
    return true;
  }
  if (text == "last-month") {
    period = month_of(day_of(days_of(today / 100 * 100 + 1) - days{1}));
    return true;
  }
  if (parse_month(text, period)) return true;
  const std::size_t dots = text.find("..");
  const std::string_view first = text.substr(0, dots);
  const std::string_view last = dots == text.npos ? first : text.substr(dots + 2);
  return parse_date(first, period.first_day) && parse_date(last, period.last_day) &&
         period.first_day <= period.last_day;
}

}  // namespace bess
