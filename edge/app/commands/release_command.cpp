// bess-edge release: ends an order that a controller which is gone has left in force.
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/program/startup.h"
#include "edge/records/log/journal.h"

namespace bess {
namespace {

struct ReleaseGiven {
  bool yes = false;
  bool force = false;
};

constexpr const char* kFooter =
    R"(For an order that a controller left behind. Needs no sign check. Refused while a bess-edge
controls the battery: stop that instead.
Exit codes:
  0 released
  1 refused or failed: the line says why
  2 the command line is wrong, or --yes is missing
Examples:
  systemctl stop bess-edge; bess-edge release --yes)";

int run_release(const ReleaseGiven& given, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  DeviceSession session;
  if (!session.begin(config)) return 1;
  ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  const auto place = battery_place(config.battery);
  if (!given.yes) {
    report(JournalLevel::kError,
           "release gives the battery at %s back to its own mode; add --yes to do that",
           place.c_str());
    return 2;
  }
  if (given.force) battery.permit_release();
  if (!reach_battery(config, battery, session.clock()) && !given.force) {
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

}  // namespace

void add_release(EdgeCommand root) {
  EdgeCommand command = root.subcommand("release", "return a battery to its own mode");
  const auto given = std::make_shared<ReleaseGiven>();
  command.flag("--yes", given->yes, "write it to the battery");
  command.flag("--force", given->force,
               "also to a device whose answers do not match its register map");
  command.footer(kFooter);
  command.does([given](SettingsFile& settings) { return run_release(*given, settings); });
}

}  // namespace bess
