#include "edge/commands/hold_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "edge/control/hold.h"
#include "edge/control/tick.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/log/whole_file.h"
#include "edge/storage/hold_file.h"
#include "edge/storage/recall.h"
#include "edge/storage/run_locks.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// Nothing is ordered while the supervision has tripped, whoever wants it.
void print_trip(const EdgeConfig& config) {
  LogReader log;
  FileMessage ignored;
  if (!log.open(config.log, ignored)) return;
  const Trip trip = standing_trip(log.ring(), log.run_ring(), clearance_paths(config));
  if (!trip.is_set()) return;
  std::printf(
      "           NOT FOLLOWED yet: tripped, %s at %s; the battery stays released until bess-edge "
      "clear "
      "--yes (first: bess-edge log --last 10)\n",
      reason_name(trip.reason).data(), utc_text(trip.utc_s).c_str());
}

void print_controller(const EdgeConfig& config) {
  if (!is_controller_running(config)) {
    std::printf(
        "           no bess-edge runs with this configuration: one that starts before then "
        "follows it\n");
  } else if (!config.control.control) {
    std::printf("           control = false: the controller logs what it would order\n");
  }
}

void print_hold(const EdgeConfig& config, const Hold& hold, std::int64_t now_utc_s) {
  const LocalMinute local = local_minute_of(hold.until_utc_s);
  const char* const direction = hold.power_w > 0   ? " (charging)"
                                : hold.power_w < 0 ? " (discharging)"
                                                   : " (at rest)";
  std::printf("hold       %d W%s until %s, %04d-%02d-%02d %02d:%02d local time\n", hold.power_w,
              direction, utc_text(hold.until_utc_s).c_str(), local.year, local.month, local.day,
              local.minute_of_day / 60, local.minute_of_day % 60);
  std::printf(
      "           from the cycle of %s on, whatever the price; stop reasons, SoC bounds, "
      "reserve, limits and ramp stay stronger\n",
      utc_text(next_tick_utc_s(now_utc_s)).c_str());
  print_controller(config);
  print_trip(config);
}

bool is_kept(const char* path, const Hold& hold) {
  return replace_file_durably(path, format_hold(hold).view());
}

bool is_gone(const char* path) {
  if (unlink(path) != 0 && errno != ENOENT) return false;
  sync_folder_of(path);
  return true;
}

void warn_of_next_boot(const HoldPaths& paths, const FileMessage& error) {
  report(JournalLevel::kWarning,
         "%s; kept in %s alone, which the next boot of this machine forgets: repeat it then",
         error.c_str(), paths.run.c_str());
}

/// One place is enough for the controller: its word is the newer one.
int keep_hold(const EdgeConfig& config, const Hold& hold, std::int64_t now_utc_s) {
  const HoldPaths paths = hold_paths(config);
  FileMessage error;
  FileMessage run_error;
  const bool in_state = is_kept(paths.state.c_str(), hold) ||
                        fail_with_errno(paths.state.c_str(), "cannot write the hold", error);
  const bool in_run = !paths.run.empty() &&
                      (is_kept(paths.run.c_str(), hold) ||
                       fail_with_errno(paths.run.c_str(), "cannot write the hold", run_error));
  if (!in_state && !in_run) {
    report(JournalLevel::kError, "%s; nothing has changed", error.c_str());
    return 1;
  }
  if (!in_state) warn_of_next_boot(paths, error);
  if (!run_error.empty()) report(JournalLevel::kWarning, "note: %s", run_error.c_str());
  print_hold(config, hold, now_utc_s);
  return 0;
}

/// What cannot be taken away is outdone by a newer word in the other place: a hold that is over.
int release_hold(const EdgeConfig& config) {
  constexpr Hold kOver{.power_w = 0, .until_utc_s = 1};
  const HoldPaths paths = hold_paths(config);
  const bool has_run = !paths.run.empty();
  FileMessage error;
  const bool of_state = is_gone(paths.state.c_str()) ||
                        fail_with_errno(paths.state.c_str(), "cannot take the hold away", error);
  const bool of_run = !has_run || is_gone(paths.run.c_str()) ||
                      fail_with_errno(paths.run.c_str(), "cannot take the hold away", error);
  const bool is_outdone = (of_state || (has_run && is_kept(paths.run.c_str(), kOver))) &&
                          (of_run || is_kept(paths.state.c_str(), kOver));
  if (!is_outdone) {
    report(JournalLevel::kError, "%s; it is still in force", error.c_str());
    return 1;
  }
  if (!of_state) warn_of_next_boot(paths, error);
  std::printf("hold       none: from the next cycle on the prices decide\n");
  return 0;
}

}  // namespace

int run_hold_command(const CommandLine& command_line, const EdgeConfig& config) {
  if (command_line.release_hold) return release_hold(config);
  const std::int64_t power_w_max = config.control.guard.power_w;
  const std::int64_t power_w = *command_line.hold_power_w;
  if (power_w > power_w_max || power_w < -power_w_max) {
    report(JournalLevel::kError,
           "hold %lld W is beyond [battery] power_w of %s: choose between -%lld and %lld",
           static_cast<long long>(power_w), command_line.config_path.c_str(),
           static_cast<long long>(power_w_max), static_cast<long long>(power_w_max));
    return 1;
  }
  set_market_time_zone();
  const std::int64_t now_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond;
  const Hold hold{.power_w = static_cast<std::int32_t>(power_w),
                  .until_utc_s = static_cast<std::uint32_t>(now_utc_s + command_line.for_s)};
  for (const FixedText<511>* const folder : {&config.state.folder, &config.state.run_folder}) {
    if (!folder->empty()) make_folder(folder->c_str());  // when it fails, the writing says why
  }
  return keep_hold(config, hold, now_utc_s);
}

}  // namespace bess
