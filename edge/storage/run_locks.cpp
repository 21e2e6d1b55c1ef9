#include "edge/storage/run_locks.h"

#include <limits.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>

#include "edge/log/journal.h"
#include "edge/storage/file_owner.h"

namespace bess {
namespace {

/// /dev/serial/by-id/... and /dev/ttyUSB0 may be one device: its real name counts. On a serial line
/// two masters cannot even share the wire, so the unit does not matter there.
FixedText<159> locked_thing(const EdgeConfig& config) {
  if (!config.battery.link.rtu) return battery_place(config.battery);
  char real[PATH_MAX];
  const char* const found = realpath(config.battery.link.device.c_str(), real);
  return {found != nullptr ? found : config.battery.link.device.c_str()};
}

bool lock_run_folder(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  const char* const folder = config.state.run_folder.c_str();
  if (*folder == '\0') return true;
  if (!make_folder(folder)) {
    static_cast<void>(
        fail_with_errno(folder, "cannot make the folder of [state] run_folder", error));
    report(JournalLevel::kWarning, "note: %s: going on without it", error.c_str());
    error = {};
    return true;
  }
  char what[560];
  std::snprintf(what, sizeof what, "the run folder %s", folder);
  return locks.run.take(run_file(config, "lock").c_str(), what, error);
}

}  // namespace

FixedText<639> battery_lock_path(const EdgeConfig& config) {
  const std::string_view folder = lock_folder();
  FixedText<159> thing = locked_thing(config);
  char name[160];
  std::size_t size = 0;
  for (const char c : thing.view()) name[size++] = c == '/' || c == ' ' || c == ':' ? '_' : c;
  char path[640];
  std::snprintf(path, sizeof path, "%.*s/bess-%.*s.lock", static_cast<int>(folder.size()),
                folder.data(), static_cast<int>(size), name);
  return {path};
}

FixedText<639> name_lock_path(const EdgeConfig& config) {
  const std::string_view folder = lock_folder();
  char path[640];
  std::snprintf(path, sizeof path, "%.*s/bess-name-%s.lock", static_cast<int>(folder.size()),
                folder.data(), config.battery.name.c_str());
  return {path};
}

std::string_view lock_folder() {
  struct stat info {};
  const bool is_there = stat("/run/lock", &info) == 0 && S_ISDIR(info.st_mode);
  return is_there ? "/run/lock" : "/tmp";
}

int controller_holding(const EdgeConfig& config) {
  const bool has_run_folder = !config.state.run_folder.empty();
  const int of_run_folder = has_run_folder ? holder_of(run_file(config, "lock").c_str()) : 0;
  if (of_run_folder > 0) return of_run_folder;
  const int of_state_folder = holder_of(state_file(config, "lock").c_str());
  return of_state_folder != 0 ? of_state_folder : of_run_folder;
}

bool is_controller_running(const EdgeConfig& config) { return controller_holding(config) != 0; }

bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  char what[200];
  std::snprintf(what, sizeof what, "the battery at %s", battery_place(config.battery).c_str());
  return locks.battery.take(battery_lock_path(config).c_str(), what, error);
}

bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error) {
  const char* const folder = config.state.folder.c_str();
  if (!make_folder(folder)) {
    return fail_with_errno(folder, "cannot make the folder of [state] folder", error);
  }
  for (const auto& path :
       {config.log.status, config.log.ring, config.log.run_status, config.log.run_ring}) {
    if (!refuse_stranger(path.c_str(), error)) return false;
  }
  char what[560];
  std::snprintf(what, sizeof what, "the state folder %s", folder);
  if (!locks.state.take(state_file(config, "lock").c_str(), what, error)) return false;
  std::snprintf(what, sizeof what, "[battery] name %s", config.battery.name.c_str());
  if (!locks.name.take(name_lock_path(config).c_str(), what, error)) return false;
  return lock_run_folder(config, locks, error);
}

}  // namespace bess
