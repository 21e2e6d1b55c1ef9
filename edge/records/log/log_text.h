// The text forms of one cycle's record: a key=value line for the journal and for people, a CSV line
// for programs. Built in a stack buffer: no stdio stream, no heap. Which fields: record_fields.h.
#pragma once

#include <cstddef>

#include "edge/core/control/control_types.h"

namespace bess {

inline constexpr std::size_t kLogLineBytes = 1'024;

// Each returns the length, without a line end.
std::size_t format_log_line(const CycleRecord& record, char (&line)[kLogLineBytes]);
std::size_t format_csv_header(char (&line)[kLogLineBytes]);
std::size_t format_csv_line(const CycleRecord& record, char (&line)[kLogLineBytes]);

}  // namespace bess
