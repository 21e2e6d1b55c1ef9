#include "edge/app/storage/published_status.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <optional>

#include "edge/app/storage/instance_lock.h"
#include "edge/app/storage/storage_health.h"
#include "edge/core/control/policy.h"
#include "edge/records/log/journal.h"
#include "edge/records/log/log_reader.h"
#include "edge/records/log/run_status.h"

namespace bess {

RunIdentity identity_of_run(const EdgeConfig& config) {
  RunIdentity identity;
  identity.name = config.battery.name;
  identity.version = BESS_VERSION;
  identity.student_hash = student_hash();
  identity.student_provenance = student_provenance();
  identity.trained_from = student_training().first_day;
  identity.trained_until = student_training().last_day;
  identity.context = context_name(student_context().kind);
  identity.map = config.battery.map.name.view();
  identity.variant = config.battery.map.variant.view();
  for (const RegisterPoint& point : config.battery.map.points) {
    identity.point_names.push_back(point.name);
  }
  identity.battery = battery_place(config.battery);
  identity.control = config.control.control;
  identity.pid = getpid();
  identity.start_utc_s = utc_seconds(config.clock);
  identity.wear = storage_wear_of(config.state.folder.c_str());
  identity.cadence_ms = kSecondsPerStep * 1'000 / config.clock.scale;
  return identity;
}

namespace {

std::int64_t age_ms_of(const RunStatus& status) {
  return clock_ns(CLOCK_MONOTONIC) / 1'000'000 - status.written_monotonic_ms;
}

/// Status of one place; nothing if missing, not trusted or damaged.
std::optional<RunStatus> stored_status(const FixedText<511>& status_json) {
  if (status_json.empty()) return std::nullopt;
  const FixedText<511> path = stored_status_path(status_json);
  if (!is_believable(path.c_str())) {
    report(JournalLevel::kWarning, "%s", foreign_file_error(path.c_str()).c_str());
    return std::nullopt;
  }
  RunStatus status;
  const StatusFile file = read_status(path.c_str(), status);
  if (file == StatusFile::kRead) return status;
  if (file == StatusFile::kDamaged) {
    report(JournalLevel::kWarning, "%s is damaged or of another version: ignored", path.c_str());
  } else if (errno == EACCES) {
    report(JournalLevel::kWarning,
           "%s is not readable by this user: run this as the service's user, or with sudo",
           path.c_str());
  }
  return std::nullopt;
}

/// Newer status of both places. A status from before the last boot is the older one.
std::optional<RunStatus> newer_status(const EdgeConfig& config) {
  const std::optional<RunStatus> of_state = stored_status(config.log.status);
  const std::optional<RunStatus> of_run = stored_status(config.log.run_status);
  if (!of_run) return of_state;
  if (!of_state) return of_run;
  const std::int64_t age_ms = age_ms_of(*of_state);
  return age_ms >= 0 && age_ms < age_ms_of(*of_run) ? of_state : of_run;
}

/// Running process that wrote the status; 0 = none. Excludes a status from before the last boot,
/// and a process id that another program has now.
int living_writer_of(const std::optional<RunStatus>& status) {
  if (!status) return 0;
  const int pid = status->identity.pid;
  if (pid <= 0 || age_ms_of(*status) < 0) return 0;
  if (kill(pid, 0) != 0 && errno != EPERM) return 0;
  const std::string name = contents_of("/proc/" + std::to_string(pid) + "/comm");
  const bool is_another = !name.empty() && name != "bess-edge\n";
  return is_another ? 0 : pid;
}

/// Whether this holds for every folder in which a controller writes status and log.
bool holds_everywhere(const EdgeConfig& config, bool (*is_trouble)(const char* folder)) {
  const char* const run_folder = config.state.run_folder.c_str();
  return is_trouble(config.state.folder.c_str()) && (*run_folder == '\0' || is_trouble(run_folder));
}

/// Age of the newest lock file of a controller; nothing without one.
std::optional<std::int64_t> lock_age_ms(const EdgeConfig& config) {
  std::optional<std::int64_t> youngest;
  for (const FixedText<639>& path :
       {state_file(config, "lock"), run_file(config, "lock"), battery_lock_path(config)}) {
    struct stat info {};
    if (path.empty() || stat(path.c_str(), &info) != 0) continue;
    const std::int64_t age_ms = (std::time(nullptr) - info.st_mtime) * 1'000;
    youngest = std::min(youngest.value_or(age_ms), age_ms);
  }
  return youngest;
}

/// Negative: a controller may run with an unknown process id.
constexpr int kUnknownProcess = -1;

/// Without checking locks: the writer of the status, or an unknown process that locked the battery
/// later.
int controller_by_files(const EdgeConfig& config, const std::optional<RunStatus>& status) {
  const int writer = living_writer_of(status);
  if (writer != 0) return writer;
  const std::optional<std::int64_t> lock_ms = lock_age_ms(config);
  const bool is_later = lock_ms.has_value() && (!status || *lock_ms + 1'000 < age_ms_of(*status));
  return is_later ? kUnknownProcess : 0;
}

/// By the locks; by the files if the locks may not be opened.
int find_controller(const EdgeConfig& config, const std::optional<RunStatus>& status,
                    bool no_lock) {
  int holder = no_lock ? kOwnerHidden : controller_holding(config);
  if (holder == 0 && holds_everywhere(config, takes_no_file)) {  // no locks there either
    holder = lock_owner_pid(battery_lock_path(config).c_str());
  }
  if (holder == kOwnerHidden) return controller_by_files(config, status);
  // On a full disk the lock file has no process id.
  const int writer = holder < 0 ? living_writer_of(status) : 0;
  return writer != 0 ? writer : holder;
}

/// Status that belongs to this record, completed from an older one of the same run.
RunStatus status_of_record(const EdgeConfig& config, const std::optional<RunStatus>& older,
                           int holder, const CycleRecord& record, std::uint64_t number) {
  RunStatus status = older.value_or(RunStatus{});
  if (!older) {
    status.identity = identity_of_run(config);
    status.identity.pid = std::max(holder, 0);
    status.identity.start_utc_s = 0;
  }
  status.totals.last = record;
  status.totals.cycles = record.cycle;
  status.totals.log_number = number;
  status.totals.disk_is_failing = true;
  const std::int64_t age_ns =
      (config.clock.now_utc_ns() - record.utc_s * kNanosecondsPerSecond) / config.clock.scale;
  status.written_monotonic_ms = (clock_ns(CLOCK_MONOTONIC) - age_ns) / 1'000'000;
  return status;
}

/// Newer control cycles in the log replace the status.
void restore_from_log(const EdgeConfig& config, PublishedStatus& published) {
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config.log, ignored) || !log.newest(newest)) return;
  const std::optional<RunStatus> older = published.status;
  const std::uint64_t known = older ? older->totals.log_number : 0;
  if (log.newest_number() <= known) return;
  published.cycles_behind =
      older ? static_cast<std::int64_t>(log.newest_number() - known) : newest.cycle;
  const bool is_same_run =
      older && (published.holder <= 0 || published.holder == older->identity.pid);
  published.status = status_of_record(config, is_same_run ? older : std::nullopt, published.holder,
                                      newest, log.newest_number());
}

std::string why_unknown(const EdgeConfig& config, const PublishedStatus& published) {
  const std::int64_t start_ms = (std::int64_t{config.battery.start_timeout_s} + 60) * 1'000;
  const bool is_starting = lock_age_ms(config).value_or(INT64_MAX) < start_ms;
  if (is_starting && !holds_everywhere(config, takes_no_file)) return "";
  const std::string who = published.holder > 0
                              ? "process " + std::to_string(published.holder) + " runs"
                              : std::string("a controller has locked this battery or its state");
  const bool has_run_folder = !config.state.run_folder.empty();
  return who + ", but there is no status and no log record: is the disk of " +
         config.state.folder.c_str() +
         (has_run_folder ? " and " + std::string(config.state.run_folder.view()) : "") +
         " full or read-only?" +
         (has_run_folder ? "" : " [state] run_folder would show its status");
}

}  // namespace

PublishedStatus read_published_status(const EdgeConfig& config, bool no_lock) {
  PublishedStatus published{.status = newer_status(config), .unknown = ""};
  published.holder = find_controller(config, published.status, no_lock);
  restore_from_log(config, published);
  const int pid = published.status ? published.status->identity.pid : 0;
  const std::int64_t cadence_ms = published.status ? published.status->identity.cadence_ms : 0;
  published.age_ms = published.status ? age_ms_of(*published.status) : 0;
  const bool is_fresh = published.cycles_behind > 0 && published.age_ms < 4 * cadence_ms;
  published.is_of_this_run = published.holder > 0 ? published.holder == pid : is_fresh;
  const bool is_old = !published.is_of_this_run || (pid == 0 && !is_fresh);
  // A status that can no longer be written is out of date.
  const bool is_stuck =
      2 * published.age_ms > 3 * cadence_ms && holds_everywhere(config, is_read_only);
  if (published.holder != 0 && (is_old || is_stuck)) {
    published.unknown = why_unknown(config, published);
  }
  return published;
}

std::uint64_t published_log_number(const EdgeConfig& config) {
  std::uint64_t newest = 0;
  for (const auto& path : {config.log.status, config.log.run_status}) {
    const std::optional<RunStatus> status = stored_status(path);
    if (status) newest = std::max(newest, status->totals.log_number);
  }
  return newest;
}

}  // namespace bess
