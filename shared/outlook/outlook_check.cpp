#include "shared/outlook/outlook_check.h"

#include "shared/crc32.h"
#include "shared/local_time.h"

namespace bess {

OutlookDays made_up_outlook_days(std::int64_t utc_s) {
  OutlookDays days = outlook_days_around(utc_s);
  constexpr int kQuarterHoursOfSixHours = 24;
  int q = 0;
  for (std::int64_t t = days.yesterday_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const bool is_hole = q % 97 == 50 || t >= days.end_utc_s - 6 * 3'600;
    const int from_peak = (q + 3) % (2 * kQuarterHoursOfSixHours) - kQuarterHoursOfSixHours;
    const int size = from_peak < 0 ? -from_peak : from_peak;
    days.day_ahead_centi[days.index_of(t)] =
        is_hole ? kDayAheadUnknown : 900 * size - 2'000 + 7 * q;
    ++q;
  }
  return days;
}

std::uint32_t outlook_check(const OutlookModel& model, OutlookPlan& plan) {
  constexpr std::int32_t kLevelCenti = 8'700;
  const OutlookDays days = made_up_outlook_days(utc_from_civil({2025, 3, 30, 10, 0, 0}));
  plan.make(model, days, planned_level_centi(kLevelCenti));
  Crc32 crc;
  for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerStep) {
    for (const std::int32_t soc_e4 : {1'000, 2'345, 5'000, 7'654, kSocFullE4}) {
      crc.add_integer(plan.break_even_centi(model, t, soc_e4, kLevelCenti));
    }
  }
  return crc.value();
}

}  // namespace bess
