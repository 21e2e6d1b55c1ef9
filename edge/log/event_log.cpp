#include "edge/log/event_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
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
  errno = ENOSPC;  // what a short write means
  return ::write(fd, line, size + 1) == static_cast<ssize_t>(size + 1);
}

bool is_unusual(const PriceReport& price) {
  constexpr std::int32_t kUsualCenti = kUnusualPriceMaxEurPerMwh * kCentiPerEur;
  return price.has_row && (price.price_centi_eur_per_mwh > kUsualCenti ||
                           price.price_centi_eur_per_mwh < -kUsualCenti);
}

JournalLevel level_of(const CycleRecord& record) {
  const bool is_ordered_stop = record.reason == Reason::kStopRequested;
  const bool is_trouble = is_stop_reason(record.reason) && !is_ordered_stop;
  const bool is_well = record.battery_status == Status::kOk && !record.price.step_held &&
                       !record.price_frozen && !is_unusual(record.price) &&
                       record.site.meter_status == Status::kOk && !record.site.trust.is_mismatch &&
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
  const auto may_go_on = [this](bool opened) {
    const bool is_disk = !opened && is_disk_trouble(errno);
    if (is_disk) totals_.disk_is_failing = true;
    return opened || is_disk;
  };
  if (!may_go_on(open_ring(error)) || !may_go_on(open_csv(error))) return false;
  if (!may_go_on(publish_metrics())) {
    return fail_with_errno(settings.metrics.c_str(), "cannot write the metrics here", error);
  }
  if (!may_go_on(publish_status())) {
    return fail_with_errno(settings.status.c_str(), "cannot write the status here", error);
  }
  tell_of_disk(totals_.disk_is_failing);
  thread_.start(
      [](void* log) -> void* {
        static_cast<EventLog*>(log)->run();
        return nullptr;
      },
      this);
  return true;
}

/// A log that has no room to grow goes on at its size; the next start tries again.
bool EventLog::open_ring(FileMessage& error) {
  const std::int64_t capacity = settings_.ring_days * kStepsPerDay;
  if (!ring_.open(settings_.ring.c_str(), capacity, error)) return false;
  if (ring_.capacity() != capacity) totals_.disk_is_failing = true;
  return true;
}

bool EventLog::open_csv(FileMessage& error) {
  const char* const path = settings_.csv.c_str();
  if (settings_.csv.empty()) return true;
  csv_fd_ = ::open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (csv_fd_ >= 0 && head_csv()) return true;
  return fail_with_errno(path, "cannot write the log here", error);
}

/// The names of the columns, where nothing stands before them.
bool EventLog::head_csv() {
  if (csv_has_head_) return true;
  struct stat info {};
  const bool is_empty = fstat(csv_fd_, &info) == 0 && info.st_size == 0;
  char line[kLogLineBytes];
  csv_has_head_ = !is_empty || append_line(csv_fd_, line, format_csv_header(line));
  return csv_has_head_;
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

/// The ring first, status last: whoever is told of a record finds it in the ring, a next run as well.
void EventLog::keep(const CycleRecord& record) {
  const std::int64_t failures_before = totals_.disk_failures;
  char line[kLogLineBytes];
  const std::size_t size = format_log_line(record, line);
  if (!append_to_ring(record)) ++totals_.disk_failures;
  tell_of_hold(record);
  tell_of_meter(record);
  write_journal_line(level_of(record), {line, size});
  tell_of_trip(record);
  if (!append_to_csv(record)) ++totals_.disk_failures;
  totals_.count(record);
  const std::int64_t dropped = dropped_;
  totals_.disk_is_slow = dropped > totals_.records_dropped;
  totals_.records_dropped = dropped;
  static_cast<void>(publish_metrics());
  totals_.disk_is_failing = totals_.disk_failures > failures_before;
  static_cast<void>(publish_status());
  tell_of_disk(totals_.disk_failures > failures_before);
}

/// On the journal, once each time: what a person has to end.
void EventLog::tell_of_trip(const CycleRecord& record) {
  if (record.is_tripped == was_tripped_) return;
  was_tripped_ = record.is_tripped;
  char line[160];
  const int size = std::snprintf(
      line, sizeof line, "tripped: %s; the battery is in its own mode until bess-edge clear",
      reason_name(record.trip.reason).data());
  write_journal_line(record.is_tripped ? JournalLevel::kError : JournalLevel::kNotice,
                     record.is_tripped ? std::string_view(line, static_cast<std::size_t>(size))
                                       : "cleared: a person lets the battery be driven again");
}

/// A log that the disk refused at the start is tried again.
bool EventLog::append_to_ring(const CycleRecord& record) {
  FileMessage ignored;
  return (ring_.is_open() || open_ring(ignored)) && ring_.append(record);
}

bool EventLog::append_to_csv(const CycleRecord& record) {
  if (settings_.csv.empty()) return true;
  FileMessage ignored;
  if (csv_fd_ < 0 ? !open_csv(ignored) : !head_csv()) return false;
  char line[kLogLineBytes];
  return append_line(csv_fd_, line, format_csv_line(record, line));
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

void EventLog::tell_of_hold(const CycleRecord& record) {
  char text[256];
  TextBuffer line(text);
  if (!hold_lines_.add_line(record, identity_.control, line)) return;
  write_journal_line(record.hold.unreadable ? JournalLevel::kWarning : JournalLevel::kNotice,
                     line.view());
}

void EventLog::tell_of_meter(const CycleRecord& record) {
  char text[320];
  TextBuffer trust(text);
  if (meter_lines_.add_trust_line(record, trust)) {
    const bool is_trouble = record.site.trust.is_mismatch;
    write_journal_line(is_trouble ? JournalLevel::kWarning : JournalLevel::kNotice, trust.view());
  }
  TextBuffer house(text);
  if (meter_lines_.add_house_line(record, house)) {
    const bool is_trouble = record.site.house_is_implausible;
    write_journal_line(is_trouble ? JournalLevel::kWarning : JournalLevel::kNotice, house.view());
  }
}

bool EventLog::publish_metrics() {
  TextBuffer metrics(metrics_text_);
  format_prometheus(identity_, totals_, metrics);
  const bool done = replace_file(settings_.metrics.c_str(), metrics.view());
  if (!done) ++totals_.disk_failures;
  return done;
}

bool EventLog::publish_status() {
  TextBuffer status(status_text_);
  format_status_json(identity_, totals_, clock_ns(CLOCK_MONOTONIC), status);
  const bool done = replace_file(settings_.status.c_str(), status.view());
  if (!done) ++totals_.disk_failures;
  return done;
}

}  // namespace bess
