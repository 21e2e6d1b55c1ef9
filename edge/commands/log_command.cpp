// `bess-edge log`: prints the decision log from the ring in the state folder, as text or CSV.
#include <algorithm>
#include <cstdio>

#include "edge/commands/command_list.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/log/log_text.h"

namespace bess {
namespace {

struct LogGiven {
  bool csv = false;
  std::int64_t last = -1;                ///< -1 = all
  std::int64_t since_utc_s = INT64_MIN;  ///< INT64_MIN = all
};

using O = OptionsOf<LogGiven>;
constexpr CommandOption kOptions[] = {
    O::flag<&LogGiven::csv>("--csv"),
    O::count<&LogGiven::last>("--last"),
    O::instant<&LogGiven::since_utc_s>("--since"),
};

constexpr const char* kHelp =
    R"(bess-edge log: what was decided in each cycle, and why

  bess-edge log [--config FILE] [--csv] [--last N] [--since UTC]

  --config FILE  the controller's settings; default /etc/bess/edge.toml
  --csv          comma-separated with a header; otherwise one key=value line a cycle
  --last N       only the newest N cycles
  --since UTC    only from this instant on, e.g. 2026-11-21T06:00:00Z

Read from the ring in [state] folder, oldest first, while the controller runs or not.
Exit codes: 0 done   1 the log cannot be read   2 the command line is bad

  bess-edge log --last 10
  bess-edge log --csv --since 2026-11-01T00:00:00Z > november.csv
)";

/// Number of the first record to print: torn ones count as records, time may have been stepped.
std::uint64_t first_number(const LogReader& log, std::int64_t last) {
  const std::uint64_t oldest = log.oldest_number();
  const std::uint64_t newest = log.newest_number();
  if (last < 0 || static_cast<std::uint64_t>(last) > newest) return oldest;
  return std::max(oldest, newest - static_cast<std::uint64_t>(last) + 1);
}

int run_log(const LogGiven& given, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  LogReader log;
  FileMessage error;
  if (!log.open(config.log, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  char line[kLogLineBytes];
  if (given.csv) {
    format_csv_header(line);
    std::puts(line);
  }
  CycleRecord record;
  for (std::uint64_t n = first_number(log, given.last); n <= log.newest_number(); ++n) {
    if (!log.read(n, record) || record.utc_s < given.since_utc_s) continue;
    given.csv ? format_csv_line(record, line) : format_log_line(record, line);
    std::puts(line);
  }
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  report(JournalLevel::kError, "the output cannot be written");
  return 1;
}

}  // namespace

const EdgeCommand kLogCommand = {.name = "log",
                                 .usage = "log [--config FILE] ...",
                                 .does = "what was decided, and why",
                                 .help = kHelp,
                                 .options = kOptions,
                                 .run = run_with<LogGiven, run_log>};

}  // namespace bess
