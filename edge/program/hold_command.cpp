#include "edge/program/hold_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "edge/control/hold.h"
#include "edge/control/tick.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/log/whole_file.h"
#include "edge/program/hold_file.h"
#include "edge/program/people_config.h"
#include "edge/program/recall.h"
#include "edge/program/run_locks.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

int fail(const char* path, const char* what) {
  FileMessage error;
  fail_with_errno(path, what, error);
  report(JournalLevel::kError, "%s", error.c_str());
  return 1;
}

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

int release_hold(const char* path) {
  if (unlink(path) != 0 && errno != ENOENT) return fail(path, "cannot take the hold away");
  sync_folder_of(path);
  std::printf("hold       none: from the next cycle on the prices decide\n");
  return 0;
}

}  // namespace

int run_hold_command(const CommandLine& command_line, const EdgeConfig& config) {
  const FixedText<639> path = hold_path(config);
  if (command_line.release_hold) return release_hold(path.c_str());
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
  if (!make_folder(config.state.folder.c_str())) {
    return fail(config.state.folder.c_str(), "cannot make the folder of [state] folder");
  }
  if (!replace_file_durably(path.c_str(), format_hold(hold).view())) {
    return fail(path.c_str(), "cannot write the hold");
  }
  print_hold(config, hold, now_utc_s);
  return 0;
}

}  // namespace bess
