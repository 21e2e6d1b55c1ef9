#include "edge/storage/published_status.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <optional>
#include <sstream>
#include <utility>

#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "edge/log/log_reader.h"
#include "edge/log/run_status.h"
#include "edge/log/whole_file.h"
#include "edge/storage/instance_lock.h"
#include "edge/storage/storage_health.h"
#include "shared/utc_text.h"

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
  identity.start_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond;
  identity.wear = card_wear_of(config.state.folder.c_str());
  identity.cadence_ms = kSecondsPerStep * 1'000 / config.clock.scale;
  return identity;
}

namespace {

using R = CycleRecord;
using T = RunTotals;

std::int64_t age_ms_of(JsonValue status) {
  return clock_ns(CLOCK_MONOTONIC) / 1'000'000 - whole(status["written_monotonic_ms"]);
}

/// Does not exist when there is none at `path`, it is not ours, or it is not as it was written.
Json read_status(const char* path) {
  std::string text;
  const bool is_believed = is_believable(path);
  if (!is_believed) report(JournalLevel::kWarning, "%s", strangers_file(path).c_str());
  if (*path == '\0' || !is_believed) return Json::parse("");
  if (!read_text(path, text)) {
    if (faccessat(AT_FDCWD, path, R_OK, AT_EACCESS) != 0 && errno == EACCES) {
      report(JournalLevel::kWarning,
             "%s is not for this user to read: ask as the user of the service, or with sudo", path);
    }
    return Json::parse("");
  }
  const TextState state = check_text(text, kJsonChecksum);
  Json status = Json::parse(state == TextState::kIntact
                                ? std::string(without_checksum(text, kJsonChecksum)) + "\n}\n"
                                : text);  // of an older program
  if (state != TextState::kBroken && status.value().is_object()) return status;
  report(JournalLevel::kWarning, "%s is damaged: not believed", path);
  return Json::parse("");
}

/// 0 when there is no such file.
std::int64_t written_ns(const char* path) {
  struct stat info {};
  if (*path == '\0' || stat(path, &info) != 0) return 0;
  return info.st_mtim.tv_sec * kNanosecondsPerSecond + info.st_mtim.tv_nsec;
}

/// Of both places the one that was written last. One of before the last boot is older than any
/// other.
Json read_newer_status(const EdgeConfig& config) {
  Json of_state = read_status(config.log.status.c_str());
  Json of_run = read_status(config.log.run_status.c_str());
  if (!of_run.value().exists()) return of_state;
  if (!of_state.value().exists()) return of_run;
  const std::int64_t age_ms = age_ms_of(of_state.value());
  const bool state_is_newer = age_ms >= 0 && age_ms < age_ms_of(of_run.value());
  return state_is_newer ? std::move(of_state) : std::move(of_run);
}

/// The process that wrote the status, while it lives; 0 = none. A status of before the last boot is
/// nobody's, nor is a number that another program has by now, where that can be seen.
int living_writer_of(JsonValue status) {
  const auto pid = static_cast<int>(whole(status["pid"]));
  if (pid <= 0 || age_ms_of(status) < 0) return 0;
  if (kill(pid, 0) != 0 && errno != EPERM) return 0;
  std::string name;
  const bool is_another =
      read_text(("/proc/" + std::to_string(pid) + "/comm").c_str(), name) && name != "bess-edge\n";
  return is_another ? 0 : pid;
}

/// Whether a controller could write a status anywhere now.
bool has_place_for_status(const EdgeConfig& config) {
  const char* const run_folder = config.state.run_folder.c_str();
  return !takes_no_file(config.state.folder.c_str()) ||
         (*run_folder != '\0' && !takes_no_file(run_folder));
}

/// Whether neither a status nor the log can have been written just now.
bool is_every_place_read_only(const EdgeConfig& config) {
  const char* const run_folder = config.state.run_folder.c_str();
  return is_read_only(config.state.folder.c_str()) &&
         (*run_folder == '\0' || is_read_only(run_folder));
}

/// How long ago the youngest of a controller's locks was made, as far as one is left.
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

/// Negative where somebody may run whose number nobody tells.
constexpr int kSomebody = -1;

/// Without asking for locks: the writer of the status, or whoever has locked the battery since.
int controller_by_files(const EdgeConfig& config, JsonValue status) {
  const int writer = living_writer_of(status);
  if (writer != 0) return writer;
  const std::optional<std::int64_t> lock_ms = lock_age_ms(config);
  const bool is_later =
      lock_ms.has_value() && (!status.exists() || *lock_ms + 1'000 < age_ms_of(status));
  return is_later ? kSomebody : 0;
}

/// Who may not open the lock, or will not, asks the files.
int find_controller(const EdgeConfig& config, JsonValue status, bool no_lock) {
  int holder = no_lock ? kHolderHidden : controller_holding(config);
  if (holder == 0 && !has_place_for_status(config)) {  // nor could it make its locks there
    holder = holder_of(battery_lock_path(config).c_str());
  }
  if (holder == kHolderHidden) return controller_by_files(config, status);
  // A full disk keeps the lock and not the number in it.
  const int writer = holder < 0 ? living_writer_of(status) : 0;
  return writer != 0 ? writer : holder;
}

RunIdentity identity_in(JsonValue status, RunIdentity identity) {
  if (!status.exists()) return identity;
  identity.version = status["version"].text_or("");
  identity.student_hash =
      static_cast<std::uint32_t>(std::strtoul(status["student"].text_or(""), nullptr, 16));
  identity.student_provenance = status["provenance"].text_or("");
  identity.context = status["context"].text_or("");
  identity.map = status["map"].text_or("");
  identity.variant = status["variant"].text_or("");
  identity.battery = status["battery"].text_or("");
  identity.control = status["control"].boolean().value_or(false);
  identity.pid = static_cast<pid_t>(whole(status["pid"]));
  static_cast<void>(parse_utc(status["start_utc"].text_or(""), identity.start_utc_s));
  return identity;
}

RunTotals totals_in(JsonValue status) {
  RunTotals totals;
  totals.written_orders = whole(field<&T::written_orders>(status));
  totals.battery_failures = whole(field<&T::battery_failures>(status));
  totals.price_failures = whole(field<&T::price_failures>(status));
  totals.records_dropped = whole(field<&T::records_dropped>(status));
  totals.disk_failures = whole(field<&T::disk_failures>(status));
  for (int i = 0; i < kReasonCount; ++i) {
    const char* const reason = reason_name(static_cast<Reason>(i)).data();
    totals.cycles_by_reason[static_cast<std::size_t>(i)] =
        whole(status["cycles_by_reason"][reason]);
  }
  return totals;
}

/// The status that should have been written with this record, by what an older one says of the run.
Json status_of_record(const EdgeConfig& config, JsonValue older, int holder,
                      const CycleRecord& record, std::uint64_t number) {
  RunIdentity identity = identity_of_run(config);
  identity.pid = std::max(holder, 0);
  identity.start_utc_s = 0;
  RunTotals totals = totals_in(older);
  totals.last = record;
  totals.cycles = record.cycle;
  totals.log_number = number;
  totals.disk_is_failing = true;
  const std::int64_t age_ns =
      (config.clock.now_utc_ns() - record.utc_s * kNanosecondsPerSecond) / config.clock.scale;
  static char storage[kStatusBytes];
  TextBuffer text(storage);
  format_status_json(identity_in(older, identity), totals, clock_ns(CLOCK_MONOTONIC) - age_ns,
                     text);
  return Json::parse(text.view());
}

/// Where the log has newer cycles than the status, they count.
void believe_the_log(const EdgeConfig& config, PublishedStatus& published) {
  LogReader log;
  FileMessage ignored;
  CycleRecord newest;
  if (!log.open(config.log, ignored) || !log.newest(newest)) return;
  const JsonValue status = published.status.value();
  const std::int64_t behind =
      static_cast<std::int64_t>(log.newest_number()) - whole(status["log_number"]);
  if (behind <= 0 || (status.exists() && !status["log_number"].exists())) return;
  published.cycles_behind = status.exists() ? behind : newest.cycle;
  const bool is_same_run = published.holder <= 0 || published.holder == whole(status["pid"]);
  published.status = status_of_record(config, is_same_run ? status : JsonValue(), published.holder,
                                      newest, log.newest_number());
}

std::string why_unknown(const EdgeConfig& config, const PublishedStatus& published) {
  const std::int64_t start_ms = (std::int64_t{config.battery.start_timeout_s} + 60) * 1'000;
  const bool is_starting = lock_age_ms(config).value_or(INT64_MAX) < start_ms;
  if (is_starting && has_place_for_status(config)) return "";
  const std::string who = published.holder > 0
                              ? "process " + std::to_string(published.holder) + " runs"
                              : std::string("a controller has locked this battery or its state");
  const bool has_run_folder = !config.state.run_folder.empty();
  return who + ", but neither a status nor the log tells of it: is the disk under " +
         config.state.folder.c_str() +
         (has_run_folder ? " and " + std::string(config.state.run_folder.view()) : "") +
         " full or read-only" + (has_run_folder ? "?" : "? [state] run_folder would tell");
}

}  // namespace

bool read_text(const char* path, std::string& text) {
  const std::ifstream file(path);
  if (!file) return false;
  std::ostringstream all;
  all << file.rdbuf();
  text = all.str();
  return true;
}

PublishedStatus read_published_status(const EdgeConfig& config, bool no_lock) {
  PublishedStatus published{.status = read_newer_status(config), .unknown = ""};
  published.holder = find_controller(config, published.status.value(), no_lock);
  believe_the_log(config, published);
  const JsonValue status = published.status.value();
  published.age_ms = status.exists() ? age_ms_of(status) : 0;
  const bool is_fresh =
      published.cycles_behind > 0 && published.age_ms < 4 * whole(status["cadence_ms"]);
  const auto pid = static_cast<int>(whole(status["pid"]));
  published.is_of_this_run = published.holder > 0 ? published.holder == pid : is_fresh;
  const bool is_old = !published.is_of_this_run || (pid == 0 && !is_fresh);
  // What cannot be written any more says nothing of now.
  const bool is_stuck =
      2 * published.age_ms > 3 * whole(status["cadence_ms"]) && is_every_place_read_only(config);
  if (published.holder != 0 && (is_old || is_stuck)) {
    published.unknown = why_unknown(config, published);
  }
  return published;
}

bool read_published_metrics(const EdgeConfig& config, std::string& text) {
  const char* newer = config.log.metrics.c_str();
  const char* older = config.log.run_metrics.c_str();
  if (written_ns(older) > written_ns(newer)) std::swap(newer, older);
  for (const char* path : {newer, older}) {
    const bool is_believed = is_believable(path);
    if (!is_believed) report(JournalLevel::kWarning, "%s", strangers_file(path).c_str());
    if (*path == '\0' || !is_believed || !read_text(path, text)) continue;
    if (check_text(text, kCommentChecksum) == TextState::kIntact) return true;
    report(JournalLevel::kWarning, "%s is damaged: not believed", path);
  }
  return false;
}

std::uint64_t published_log_number(const EdgeConfig& config) {
  std::int64_t newest = 0;
  for (const char* path : {config.log.status.c_str(), config.log.run_status.c_str()}) {
    const Json status = read_status(path);
    newest = std::max<std::int64_t>(newest, whole(status.value()["log_number"]));
  }
  return static_cast<std::uint64_t>(newest);
}

}  // namespace bess
