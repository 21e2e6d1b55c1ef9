#include "workstation/data/market/series/local_date.h"

#include <fmt/core.h>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {

LocalDate parse_local_date(std::string_view text, std::string_view what) {
  std::int64_t utc_s = 0;
  if (text.size() != 10 || !parse_utc(std::string(text) + "T00:00:00Z", utc_s)) {
    fail("{} \"{}\" is not a date; write it as 2023-01-31", what, text.substr(0, 40));
  }
  const CivilTime t = civil_from_utc(utc_s);
  return {t.year, t.month, t.day};
}

std::string format_local_date(const LocalDate& date) {
  return fmt::format("{:04}-{:02}-{:02}", date.year, date.month, date.day);
}

LocalDate add_days(const LocalDate& date, int days) {
  const std::int64_t utc_s = utc_from_civil({date.year, date.month, date.day, 0, 0, 0});
  const CivilTime t = civil_from_utc(utc_s + days * kSecondsPerDay);
  return {t.year, t.month, t.day};
}

LocalDate local_date_of(std::int64_t utc_s) {
  const LocalMinute local = local_minute_of(utc_s);
  return {local.year, local.month, local.day};
}

std::int64_t local_midnight_utc_s(const LocalDate& date) {
  return utc_from_local({date.year, date.month, date.day, 0, 0, 0});
}

}  // namespace bess
