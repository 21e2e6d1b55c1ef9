#include "edge/program/clear_command.h"

#include <cstdio>

#include "edge/log/journal.h"
#include "edge/log/ring_log.h"
#include "edge/log/whole_file.h"
#include "edge/program/run_locks.h"
#include "edge/program/trip_clearance.h"
#include "shared/utc_text.h"

namespace bess {

int run_clear_command(const CommandLine& command_line, const EdgeConfig& config) {
  RingLog ring;
  FileMessage error;
  if (!ring.open_to_read(config.log.ring.c_str(), error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  const Trip trip = standing_trip(ring, config);
  if (!trip.is_set()) {
    std::printf("nothing to clear: the supervision has not tripped\n");
    return 0;
  }
  std::printf("tripped    %s at %s\n", reason_name(trip.reason).data(),
              utc_text(trip.utc_s).c_str());
  if (!command_line.yes) {
    report(JournalLevel::kError,
           "find out why first (bess-edge log --last 10); then add --yes to let it drive again");
    return 2;
  }
  const auto path = trip_clearance_path(config);
  if (!clear_trip_of(path.c_str(), trip.utc_s)) {
    fail_with_errno(path.c_str(), "cannot be written", error);
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  std::printf("cleared    the battery is driven again from the next %s on\n",
              is_controller_running(config) ? "cycle" : "start");
  return 0;
}

}  // namespace bess
