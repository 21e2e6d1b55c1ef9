// Clearing of a trip by a person: `bess-edge clear`.
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/app/storage/restored_state.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/journal.h"
#include "edge/records/log/log_reader.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr const char* kClearFooter =
    R"(A trip (wrong_direction, uncontrolled_power, soc_mismatch, state_lost) leaves the battery in
its own mode, also over restarts, until this command. A running controller continues at its next
control cycle.
Exit codes:
  0 cleared, or nothing to clear
  1 log or state folder not accessible
  2 command line error, or --yes missing
Examples:
  bess-edge log --last 10; bess-edge clear --yes)";

/// False with one line when the clearance cannot be written.
bool leave_word(const char* path, std::int64_t trip_utc_s, FileMessage& error) {
  return clear_trip_of(path, trip_utc_s) || fail_with_errno(path, "cannot be written", error);
}

/// Written to both folders; one is enough for the controller.
int clear(const EdgeConfig& config, const StateFilePaths& paths, const Trip& trip) {
  FileMessage state_error;
  FileMessage run_error;
  const bool in_state = leave_word(paths.state.c_str(), trip.utc_s, state_error);
  const bool in_run = !paths.run.empty() && leave_word(paths.run.c_str(), trip.utc_s, run_error);
  if (!in_state) report(JournalLevel::kError, "%s", state_error.c_str());
  if (!run_error.empty()) report(JournalLevel::kWarning, "%s", run_error.c_str());
  if (!in_state && !in_run) {
    return failed("not cleared: the battery stays released; correct the disk error, then repeat");
  }
  std::printf("cleared    control continues from the next %s\n",
              is_controller_running(config) ? "control cycle" : "start");
  if (!in_state) {
    std::printf(
        "           stored only in %s, lost at the next boot: then repeat bess-edge clear --yes\n",
        paths.run.c_str());
  }
  return 0;
}

int run_clear(bool yes, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  LogReader log;
  FileMessage error;
  if (!log.open(config.log, error)) {
    return failed(std::string(error.view()) + ": trip state unknown");
  }
  if (!error.empty()) report(JournalLevel::kWarning, "note: %s", error.c_str());
  const StateFilePaths paths = state_file_paths(config, kClearedFileName);
  const std::optional<Trip> trip = standing_trip(log.ring(), log.run_ring(), paths);
  if (!trip) {
    std::printf("nothing to clear: no trip\n");
    return 0;
  }
  std::printf("tripped    %s at %s local time\n", reason_name(trip->reason).data(),
              local_text(trip->utc_s).c_str());
  if (!yes) {
    report(JournalLevel::kError,
           "check the cause (bess-edge log --last 10), then repeat with --yes");
    return 2;
  }
  return clear(config, paths, *trip);
}

}  // namespace

void add_clear(EdgeCommand root) {
  EdgeCommand command = root.subcommand("clear", "clear a trip after its cause is found");
  const auto yes = std::make_shared<bool>(false);
  command.flag("--yes", *yes, "clear the trip; default: only show it");
  command.footer(kClearFooter);
  command.set_action([yes](SettingsFile& settings) { return run_clear(*yes, settings); });
}

}  // namespace bess
