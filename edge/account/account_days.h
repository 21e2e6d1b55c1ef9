// The accounts of local days, from the decision log.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "edge/account/day_account.h"
#include "edge/log/log_reader.h"

namespace bess {

/// As 20231126.
std::int32_t local_day_at(std::int64_t utc_s);

/// The records of those local days, both ends included, the newest first.
void for_each_record(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                     const std::function<void(std::int32_t day, const CycleRecord&)>& visit);

/// The days from `first_day` to `last_day` of which the log has a cycle, oldest first.
std::vector<DayAccount> accounts_of_days(const LogReader& log, std::int32_t first_day,
                                         std::int32_t last_day);

}  // namespace bess
