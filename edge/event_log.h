// The decision log: one key=value line a cycle on stdout (for the journal) and one CSV line in a
// file. Lines are built in a stack buffer and written with write(2): no stdio buffers, no heap.
#pragma once

#include <cstddef>

#include "edge/control_types.h"

namespace bess {

inline constexpr std::size_t kLogLineBytes = 512;

/// Texts of one record; return the length, without the line end.
std::size_t format_log_line(const CycleRecord& record, char (&line)[kLogLineBytes]);
std::size_t format_csv_line(const CycleRecord& record, char (&line)[kLogLineBytes]);
const char* csv_header();

class EventLog {
 public:
  EventLog() = default;
  EventLog(const EventLog&) = delete;
  EventLog& operator=(const EventLog&) = delete;
  ~EventLog();

  /// Opens the CSV file for appending; an empty path means stdout only. False with errno set.
  bool open(const char* csv_path);
  void write(const CycleRecord& record);
  /// One line of free text on stdout, e.g. at start and stop.
  void note(const char* text);

 private:
  int csv_fd_ = -1;
};

}  // namespace bess
