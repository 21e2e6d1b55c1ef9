#include "edge/program/log_command.h"

#include <algorithm>
#include <cstdio>

#include "edge/log/journal.h"
#include "edge/log/log_text.h"
#include "edge/log/ring_log.h"

namespace bess {
namespace {

/// Number of the first record to print: torn ones count as records, time may have been stepped.
std::uint64_t first_number(const RingLog& ring, std::int64_t last) {
  const std::uint64_t oldest = ring.oldest_number();
  const std::uint64_t newest = ring.newest_number();
  if (last < 0 || static_cast<std::uint64_t>(last) > newest) return oldest;
  return std::max(oldest, newest - static_cast<std::uint64_t>(last) + 1);
}

}  // namespace

int run_log_command(const CommandLine& command_line, const EdgeConfig& config) {
  RingLog ring;
  FileMessage error;
  if (!ring.open_to_read(config.log.ring.c_str(), error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  char line[kLogLineBytes];
  if (command_line.csv) {
    format_csv_header(line);
    std::puts(line);
  }
  CycleRecord record;
  for (std::uint64_t n = first_number(ring, command_line.last); n <= ring.newest_number(); ++n) {
    if (!ring.read(n, record) || record.utc_s < command_line.since_utc_s) continue;
    command_line.csv ? format_csv_line(record, line) : format_log_line(record, line);
    std::puts(line);
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  report(JournalLevel::kError, "the output cannot be written");
  return 1;
}

}  // namespace bess
