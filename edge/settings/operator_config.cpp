#include "edge/settings/operator_config.h"

#include <string>

#include "edge/control/full_charge.h"

namespace bess {
namespace {

/// "17:00", or "24:00" for the end of the day.
bool parse_time_of_day(std::string_view text, std::int16_t& minute) {
  const auto is_digit = [&](std::size_t i) { return text[i] >= '0' && text[i] <= '9'; };
  if (text.size() != 5 || text[2] != ':') return false;
  if (!is_digit(0) || !is_digit(1) || !is_digit(3) || !is_digit(4)) return false;
  const int hours = (text[0] - '0') * 10 + (text[1] - '0');
  const int minutes = (text[3] - '0') * 10 + (text[4] - '0');
  if (minutes > 59 || hours * 60 + minutes > kMinutesPerDay) return false;
  minute = static_cast<std::int16_t>(hours * 60 + minutes);
  return true;
}

void read_time(TomlTable& table, std::string_view key, std::int16_t& minute) {
  table.require(key);
  const std::string* const text = table.text(key);
  if (text == nullptr || parse_time_of_day(*text, minute)) return;
  table.fail(key, "must be a local time of day such as \"17:00\", \"24:00\" at the latest");
}

void read_months(TomlTable& table, ReservePeriod& period) {
  const TomlArray* const months = table.array("months");
  if (months == nullptr) return;
  period.months = 0;
  for (const TomlValue& month : *months) {
    const std::int64_t* const number = month.as<std::int64_t>();
    if (number == nullptr || *number < 1 || *number > 12) {
      return table.fail("months", "must hold months, 1 to 12");
    }
    period.months |= static_cast<std::uint16_t>(1 << (*number - 1));
  }
  if (period.months == 0) table.fail("months", "is empty: leave it out for every month");
}

ReservePeriod read_period(TomlTable table, const GuardSettings& guard) {
  ReservePeriod period;
  std::int32_t soc_e4 = 0;
  read_time(table, "from", period.from_minute);
  read_time(table, "to", period.to_minute);
  table.require("soc");
  table.scaled("soc", soc_e4, 10'000, 0, 1);
  read_months(table, period);
  table.finish();
  if (period.from_minute == period.to_minute) {
    table.fail("to", "is the same as from: a whole day is \"00:00\" to \"24:00\"");
  }
  if (soc_e4 + 2 * guard.soc_hysteresis_e4 >= guard.soc_max_e4) {
    table.fail("soc", "must be below [guard] soc_max by more than 0.01");
  }
  period.soc_e4 = static_cast<std::int16_t>(soc_e4);
  return period;
}

}  // namespace

void read_full_charge(TomlTable& battery, ControlSettings& control) {
  battery.integer("full_charge_every_days", control.full_charge_every_days, 0, 365);
  control.guard.full_charge_power_w = control.guard.power_w / 2;
}

void check_full_charge(TomlTable& battery, const ControlSettings& control) {
  if (control.full_charge_every_days == 0) return;
  if (control.guard.soc_max_e4 >= FullCharge::kFullE4) return;
  battery.fail("full_charge_every_days",
               "needs [guard] soc_max of at least 0.995, else no charge is full");
}

void read_reserve(TomlTable& root, ControlSettings& control) {
  const TomlArray* const periods = root.array("reserve");
  if (periods == nullptr) return;
  for (const TomlValue& value : *periods) {
    if (!root.ok()) return;
    if (value.as<TomlMembers>() == nullptr) {
      return root.fail("reserve", "must hold tables: [[reserve]] with from, to and soc");
    }
    const ReservePeriod period =
        read_period(TomlTable(&value, root.file(), "[[reserve]]", root.error()), control.guard);
    if (control.reserve.try_push_back(period)) continue;
    return root.fail("reserve", "has more than " + std::to_string(ReservePlan::capacity()) +
                                    " periods: leave some out");
  }
}

}  // namespace bess
