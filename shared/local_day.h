// Local day as one number, 20231126, for ordering and lookup.
#pragma once

#include "shared/local_time.h"

namespace bess {

constexpr std::int32_t local_day_of(const LocalMinute& now) {
  return (now.year * 100 + now.month) * 100 + now.day;
}
inline std::int32_t local_day_at(std::int64_t utc_s) {
  return local_day_of(local_minute_of(utc_s));
}

}  // namespace bess
