#include "edge/account/account_days.h"

#include <map>

#include "shared/local_time.h"

namespace bess {

std::int32_t local_day_at(std::int64_t utc_s) { return local_day_of(local_minute_of(utc_s)); }

void for_each_record(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                     const std::function<void(std::int32_t, const CycleRecord&)>& visit) {
  CycleRecord record;
  for (std::uint64_t n = log.newest_number(); n >= log.oldest_number() && n > 0; --n) {
    if (!log.read(n, record)) continue;
    const std::int32_t day = local_day_at(record.utc_s);
    if (day < first_day) break;
    if (day <= last_day) visit(day, record);
  }
}

std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day) {
  std::map<std::int32_t, DayAccount> days;
  for_each_record(log, first_day, last_day, [&](std::int32_t day, const CycleRecord& record) {
    days.try_emplace(day, day).first->second.add(record);
  });
  std::vector<DayAccount> accounts;
  for (const auto& [day, account] : days) {
    if (!account.is_empty()) accounts.push_back(account);
  }
  return accounts;
}

}  // namespace bess
