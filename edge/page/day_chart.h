// The day so far as a picture: price with what was ordered in colours, state of charge, power
// ordered and measured.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/control/control_types.h"
#include "shared/host/json.h"

namespace bess {

/// Both ends of a local day; 23, 24 or 25 hours.
struct DaySpan {
  std::int64_t start_utc_s = 0;
  std::int64_t end_utc_s = 0;
};

DaySpan day_span_at(std::int64_t utc_s);

/// As an SVG element. `records` are of that day, oldest first.
std::string day_picture(const std::vector<CycleRecord>& records, const DaySpan& day);

/// The same as numbers: a list, an object a cycle.
Json day_json(const std::vector<CycleRecord>& records);

}  // namespace bess
