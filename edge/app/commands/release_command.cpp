// Release of a battery from an order that a stopped controller left: `bess-edge release`.
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/program/startup.h"
#include "edge/records/log/journal.h"
#include "shared/host/text.h"

namespace bess {
namespace {

struct ReleaseOptions {
  bool yes = false;
  bool force = false;
};

constexpr const char* kReleaseFooter =
    R"(Ends an order that a stopped controller left in force. Needs no sign check. Refused while a
bess-edge controls the battery: stop that controller instead.
Exit codes:
  0 released
  1 refused or failed, with the cause
  2 command line error, or --yes missing
Examples:
  systemctl stop bess-edge; bess-edge release --yes)";

int run_release(const ReleaseOptions& options, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  DeviceSession session;
  if (!session.begin(config)) return 1;
  ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  const auto place = battery_place(config.battery);
  if (!options.yes) {
    report(JournalLevel::kError,
           "release returns the battery at %s to its own mode: repeat with --yes", place.c_str());
    return 2;
  }
  if (options.force) battery.permit_release();
  if (!reach_battery(config, battery, *session.clock) && !options.force) {
    return failed("not released; --force releases it anyway");
  }
  const Status status = battery.release();
  if (status != Status::kOk) {
    return failed(formatted("release %s: %s", place.c_str(), status_text(status).data()));
  }
  std::printf("released   %s is in its own mode\n", place.c_str());
  return 0;
}

}  // namespace

void add_release(EdgeCommand root) {
  EdgeCommand command = root.subcommand("release", "return a battery to its own mode");
  const auto options = std::make_shared<ReleaseOptions>();
  command.flag("--yes", options->yes, "required: release the battery now");
  command.flag("--force", options->force,
               "release even if the device does not match its register map");
  command.footer(kReleaseFooter);
  command.set_action([options](SettingsFile& settings) { return run_release(*options, settings); });
}

}  // namespace bess
