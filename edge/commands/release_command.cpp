#include "edge/commands/release_command.h"

#include <cstdio>

#include "edge/log/journal.h"
#include "edge/program/startup.h"

namespace bess {

int run_release_command(const CommandLine& command_line, const EdgeConfig& config,
                        ModbusBattery& battery, EdgeClock& clock) {
  const auto place = battery_place(config);
  if (!command_line.yes) {
    report(JournalLevel::kError,
           "release gives the battery at %s back to its own mode; add --yes to do that",
           place.c_str());
    return 2;
  }
  if (command_line.force) battery.permit_release();
  if (!reach_battery(config, battery, clock) && !command_line.force) {
    report(JournalLevel::kError, "nothing was released; --force releases it all the same");
    return 1;
  }
  const Status status = battery.release();
  if (status != Status::kOk) {
    report(JournalLevel::kError, "release %s: %s", place.c_str(), status_text(status).data());
    return 1;
  }
  std::printf("released   %s is in its own mode\n", place.c_str());
  return 0;
}

}  // namespace bess
