// Calendar days of the market's local time: what users write on the command line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace bess {

struct LocalDate {
  int year, month, day;
  friend constexpr auto operator<=>(const LocalDate&, const LocalDate&) = default;
};

/// Reads YYYY-MM-DD; `what` names the option in the UserError of anything else.
LocalDate parse_local_date(std::string_view text, std::string_view what);
std::string format_local_date(const LocalDate& date);
LocalDate add_days(const LocalDate& date, int days);
LocalDate local_date_of(std::int64_t utc_s);

/// UTC instant at which the local day begins. Needs the market's time zone.
std::int64_t local_midnight_utc_s(const LocalDate& date);

}  // namespace bess
