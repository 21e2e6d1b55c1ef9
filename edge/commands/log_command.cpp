#include "edge/commands/log_command.h"

#include <algorithm>
#include <cstdio>

#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/log/log_text.h"

namespace bess {
namespace {

/// Number of the first record to print: torn ones count as records, time may have been stepped.
std::uint64_t first_number(const LogReader& log, std::int64_t last) {
  const std::uint64_t oldest = log.oldest_number();
  const std::uint64_t newest = log.newest_number();
  if (last < 0 || static_cast<std::uint64_t>(last) > newest) return oldest;
  return std::max(oldest, newest - static_cast<std::uint64_t>(last) + 1);
}

}  // namespace

int run_log_command(const CommandLine& command_line, const EdgeConfig& config) {
  LogReader log;
  FileMessage error;
  if (!log.open(config.log, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  char line[kLogLineBytes];
  if (command_line.csv) {
    format_csv_header(line);
    std::puts(line);
  }
  CycleRecord record;
  for (std::uint64_t n = first_number(log, command_line.last); n <= log.newest_number(); ++n) {
    if (!log.read(n, record) || record.utc_s < command_line.since_utc_s) continue;
    command_line.csv ? format_csv_line(record, line) : format_log_line(record, line);
    std::puts(line);
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  report(JournalLevel::kError, "the output cannot be written");
  return 1;
}

}  // namespace bess
