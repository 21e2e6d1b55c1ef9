// Text forms of a record: a key=value line for journal and people, a CSV line for programs. Built
// in a stack buffer: no stdio stream, no heap. Fields: record_fields.h.
#pragma once

#include <cstddef>
#include <cstdint>

#include "edge/core/control/control_types.h"
#include "shared/units_and_limits.h"

namespace bess {

inline constexpr std::size_t kLogLineBytes = 1'024;

// Each returns the length, without a line end.
std::size_t format_log_line(const CycleRecord& record, char (&line)[kLogLineBytes]);
/// For people: local time, order, price, SoC and reason, below kShortLineHead.
std::size_t format_short_line(const CycleRecord& record, char (&line)[kLogLineBytes]);
inline constexpr const char* kShortLineHead =
    "local time         ordered W  price EUR/MWh   SoC %  reason";
std::size_t format_csv_header(char (&line)[kLogLineBytes]);
std::size_t format_csv_line(const CycleRecord& record, char (&line)[kLogLineBytes]);

/// EUR/MWh from hundredths.
constexpr double eur_of(std::int64_t centi) { return static_cast<double>(centi) / kCentiPerEur; }

/// Power of the house behind the meter, without the battery.
constexpr std::int64_t house_w_of(const CycleRecord& record) {
  return std::int64_t{record.site.grid_power_w} - record.measurement.power_w;
}

}  // namespace bess
