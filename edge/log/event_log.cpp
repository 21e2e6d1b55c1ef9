#include "edge/log/event_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "edge/log/journal.h"
#include "edge/log/log_text.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

bool append_line(int fd, const char* text, std::size_t size) {
  char line[kLogLineBytes + 1];
  std::memcpy(line, text, size);
  line[size] = '\n';
  return ::write(fd, line, size + 1) == static_cast<ssize_t>(size + 1);
}

JournalLevel level_of(const CycleRecord& record) {
  const bool is_ordered_stop = record.reason == Reason::kStopRequested;
  const bool is_trouble = is_stop_reason(record.reason) && !is_ordered_stop;
  const bool is_well = record.battery_status == Status::kOk &&
                       record.site.meter_status == Status::kOk &&
                       record.site.limit_status == Status::kOk;
  return is_trouble || !is_well ? JournalLevel::kWarning : JournalLevel::kInfo;
}

}  // namespace

EventLog::~EventLog() {
  if (thread_.is_running()) {
    ending_ = true;
    queue_.wake();
    thread_.join();
  }
  if (csv_fd_ >= 0) close(csv_fd_);
}

bool EventLog::open(const EventLogSettings& settings, const RunIdentity& identity,
                    FileMessage& error) {
  settings_ = settings;
  identity_ = identity;
  if (!ring_.open(settings.ring.c_str(), settings.ring_days * kStepsPerDay, error)) return false;
  if (!open_csv(settings.csv.c_str(), error)) return false;
  publish_metrics();
  if (totals_.disk_failures > 0) {
    return fail_with_errno(settings.metrics.c_str(), "cannot write the metrics here", error);
  }
  publish_status();
  if (totals_.disk_failures > 0) {
    return fail_with_errno(settings.status.c_str(), "cannot write the status here", error);
  }
  thread_.start(
      [](void* log) -> void* {
        static_cast<EventLog*>(log)->run();
        return nullptr;
      },
      this);
  return true;
}

bool EventLog::open_csv(const char* path, FileMessage& error) {
  if (*path == '\0') return true;
  csv_fd_ = ::open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (csv_fd_ < 0) return fail_with_errno(path, "cannot write the log here", error);
  struct stat info {};
  const bool is_empty = fstat(csv_fd_, &info) == 0 && info.st_size == 0;
  char line[kLogLineBytes];
  if (is_empty && !append_line(csv_fd_, line, format_csv_header(line))) {
    return fail_with_errno(path, "cannot write the log here", error);
  }
  return true;
}

void EventLog::write(const CycleRecord& record) {
  if (queue_.push(record)) {
    ++handed_over_;
  } else {
    ++dropped_;
  }
}

bool EventLog::drain(std::int64_t wall_ns_max) const {
  constexpr std::int64_t kSliceNs = 2'000'000;
  const std::int64_t deadline_ns = clock_ns(CLOCK_MONOTONIC) + wall_ns_max;
  while (kept_.load() < handed_over_) {
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    if (now_ns >= deadline_ns) return false;
    sleep_until_monotonic(now_ns + kSliceNs);
  }
  return true;
}

void EventLog::run() {
  CycleRecord record;
  while (true) {
    if (queue_.wait_and_pop(record)) {
      keep(record);
      ++kept_;
    } else if (ending_) {
      return;
    }
  }
}

/// Status last: whoever reads it finds the record in the ring as well.
void EventLog::keep(const CycleRecord& record) {
  const std::int64_t failures_before = totals_.disk_failures;
  char line[kLogLineBytes];
  const std::size_t size = format_log_line(record, line);
  write_journal_line(level_of(record), {line, size});
  if (!ring_.append(record)) ++totals_.disk_failures;
  if (csv_fd_ >= 0 && !append_line(csv_fd_, line, format_csv_line(record, line))) {
    ++totals_.disk_failures;
  }
  totals_.count(record);
  const std::int64_t dropped = dropped_;
  totals_.disk_is_slow = dropped > totals_.records_dropped;
  totals_.records_dropped = dropped;
  publish_metrics();
  totals_.disk_is_failing = totals_.disk_failures > failures_before;
  publish_status();
  tell_of_disk(totals_.disk_failures > failures_before);
}

/// On the journal, once each time: the files that would tell of it cannot be written.
void EventLog::tell_of_disk(bool is_failing) {
  if (is_failing == was_failing_) return;
  was_failing_ = is_failing;
  write_journal_line(
      JournalLevel::kWarning,
      is_failing ? "the files of [state], [log] or [metrics] cannot be written, is the disk full "
                   "or read-only? The battery is driven on"
                 : "the files of [state], [log] and [metrics] are written again");
}

void EventLog::publish_metrics() {
  TextBuffer metrics(metrics_text_);
  format_prometheus(identity_, totals_, metrics);
  if (!replace_file(settings_.metrics.c_str(), metrics.view())) ++totals_.disk_failures;
}

void EventLog::publish_status() {
  TextBuffer status(status_text_);
  format_status_json(identity_, totals_, clock_ns(CLOCK_MONOTONIC), status);
  if (!replace_file(settings_.status.c_str(), status.view())) ++totals_.disk_failures;
}

}  // namespace bess
