#include "edge/records/log/event_log.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "edge/records/log/journal.h"
#include "edge/records/log/log_text.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

bool ChangeLines::add_hold_line(const CycleRecord& record, const RunIdentity& identity,
                                TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;  // it reads no hold; the next run continues it
  const HoldReport now = record.hold;
  const HoldReport before = std::exchange(hold_, now);
  if (now.unreadable) {
    if (before.unreadable) return false;
    line.add(
        "hold: file hold in [state] folder is malformed or ends too late, hold ignored: repeat "
        "bess-edge hold, or bess-edge hold --release");
    return true;
  }
  if (now.held) {
    const bool is_same =
        before.held && before.power_w == now.power_w && before.until_utc_s == now.until_utc_s;
    if (is_same) return false;
    line.add("hold: %d W until %s%s", now.power_w, utc_text(now.until_utc_s).c_str(),
             identity.control ? "" : " (read-only: not written)");
    return true;
  }
  if (before.held) {
    const bool is_early = record.utc_s < std::int64_t{before.until_utc_s};
    line.add("hold: %s; prices decide again", is_early ? "released" : "over");
    return true;
  }
  if (before.unreadable) line.add("hold: none; prices decide again");
  return before.unreadable;
}

bool ChangeLines::add_trust_line(const CycleRecord& record, const RunIdentity&, TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;  // no measurement; the next run continues
  const MeterTrust& trust = record.site.trust;
  if (std::exchange(was_mismatch_, trust.is_mismatch) == trust.is_mismatch) return false;
  if (trust.is_mismatch) {
    line.add(
        "meter: does not respond to battery steps: frozen, inverted, late, wrong phase or ratio, "
        "or wrong battery power; treated as lost, tested again from %s",
        utc_text(trust.pause_until_utc_s).c_str());
  } else {
    line.add("meter: responds to battery steps again and is used");
  }
  return true;
}

bool ChangeLines::add_house_line(const CycleRecord& record, const RunIdentity&, TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;
  const bool is_implausible = record.site.house_is_implausible;
  if (std::exchange(was_implausible_, is_implausible) == is_implausible) return false;
  if (is_implausible) {
    line.add(
        "meter: grid %d W less battery %d W gives a negative house load: check signs, phase and "
        "position of the meter; with solar panels, set [meter] pv_w_max",
        record.site.grid_power_w, record.measurement.power_w);
  } else {
    line.add("meter: the house's load is plausible again");
  }
  return true;
}

namespace {

/// `number`: 1 + index, 0 = none.
const char* name_of(const RunIdentity& identity, int number) {
  const bool is_known = number > 0 && number <= identity.point_names.size();
  return is_known ? identity.point_names[number - 1].c_str() : "a register";
}

}  // namespace

bool ChangeLines::add_lost_line(const CycleRecord& record, const RunIdentity& identity,
                                TextBuffer& line) {
  const std::int16_t now = record.measurement.lost_point;
  const std::int16_t before = std::exchange(lost_, now);
  if (record.mode == Mode::kStopping || now == before) return false;
  line.add(now != 0 ? "battery: %s not read or implausible" : "battery: %s is read again",
           name_of(identity, now != 0 ? now : before));
  return true;
}

bool ChangeLines::add_cut_line(const CycleRecord& record, const RunIdentity& identity,
                               TextBuffer& line) {
  if (!record.has_measurement) return false;
  const std::int16_t now = record.measurement.cut_point;
  if (std::exchange(cut_, now) == now || now == 0) return false;
  line.add("battery: %s is out of range and was clamped (SoC %.2f %%)", name_of(identity, now),
           record.measurement.soc_e4 / 100.0);
  return true;
}

namespace {

/// Ring of the run folder: the eight hours that supervision restores at a start.
constexpr std::int64_t kRunRecords = 256;

bool append_line(int fd, const char* text, std::size_t size) {
  char line[kLogLineBytes + 1];
  std::memcpy(line, text, size);
  line[size] = '\n';
  return append_whole(fd, {line, size + 1});
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
  queue_.finish();
  if (csv_fd_ >= 0) close(csv_fd_);
}

bool EventLog::open(const EventLogSettings& settings, const RunIdentity& identity,
                    FileMessage& error) {
  settings_ = settings;
  stored_.status.identity = identity;
  const auto may_go_on = [this](bool opened) {
    const bool is_disk = !opened && is_disk_trouble(errno);
    if (is_disk) totals_.disk_is_failing = true;
    return opened || is_disk;
  };
  open_run_ring();
  if (!may_go_on(open_ring(error)) || !may_go_on(open_csv(error))) return false;
  report_damage(ring_, settings_.ring.c_str());
  totals_.log_number = newer_ring().newest_number();
  if (!may_go_on(publish_metrics(settings.metrics.c_str()))) {
    return fail_with_errno(settings.metrics.c_str(), "cannot write the metrics here", error);
  }
  if (!may_go_on(publish_status(settings.status))) {
    return fail_with_errno(settings.status.c_str(), "cannot write the status here", error);
  }
  publish_in_memory();
  report_disk(totals_.disk_is_failing, nullptr);
  report_run_folder();
  queue_.start<&EventLog::take>(this);
  return true;
}

/// A log without room to grow keeps its size; the next start tries again.
bool EventLog::open_ring(FileMessage& error) {
  const std::int64_t capacity = settings_.ring_days * kStepsPerDay;
  if (!ring_.open(settings_.ring.c_str(), capacity, error)) return false;
  if (ring_.capacity() != capacity) totals_.disk_is_failing = true;
  return true;
}

/// A failure is retried with every record.
void EventLog::open_run_ring() {
  if (settings_.run_ring.empty()) return;
  FileMessage ignored;
  if (!run_ring_.open(settings_.run_ring.c_str(), kRunRecords, ignored)) {
    totals_.run_folder_is_failing = true;
    return;
  }
  report_damage(run_ring_, settings_.run_ring.c_str());
}

void EventLog::report_damage(const RingLog& ring, const char* path) const {
  if (!ring.damage().is_any()) return;
  char text[1'024];
  TextBuffer line(text);
  describe_damage(ring.damage(), path, line);
  write_journal_line(JournalLevel::kError, line.view());
}

bool EventLog::open_csv(FileMessage& error) {
  const char* const path = settings_.csv.c_str();
  if (settings_.csv.empty()) return true;
  csv_fd_ = ::open(path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (csv_fd_ >= 0 && head_csv()) return true;
  return fail_with_errno(path, "cannot write the log here", error);
}

/// Writes the column names into an empty file.
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

void EventLog::take(const CycleRecord& record) {
  keep(record);
  ++kept_;
}

/// Write order: rings before status, so that a published record is always readable.
void EventLog::keep(const CycleRecord& record) {
  const std::uint64_t number = newer_ring().newest_number() + 1;
  const std::int64_t dropped = dropped_;
  totals_.disk_is_slow = dropped > totals_.records_dropped;
  totals_.records_dropped = dropped;
  totals_.count(record);
  totals_.log_number = number;
  keep_in_memory(record, number);
  keep_on_disk(record, number);
  report_run_folder();
}

void EventLog::keep_in_memory(const CycleRecord& record, std::uint64_t number) {
  if (settings_.run_ring.empty()) return;
  totals_.run_folder_is_failing = !append_to_run_ring(record, number);
  publish_in_memory();
}

/// The disk may block without end here: the run folder already has the record.
void EventLog::keep_on_disk(const CycleRecord& record, std::uint64_t number) {
  const std::int64_t failures_before = totals_.disk_failures;
  char line[kLogLineBytes];
  const std::size_t size = format_log_line(record, line);
  if (!append_to_ring(record, number)) ++totals_.disk_failures;
  report_changes(record);
  write_journal_line(level_of(record), {line, size});
  report_trip(record);
  if (!append_to_csv(record)) ++totals_.disk_failures;
  if (!publish_metrics(settings_.metrics.c_str())) ++totals_.disk_failures;
  const bool was_failing = totals_.disk_is_failing;
  totals_.disk_is_failing = totals_.disk_failures > failures_before;
  if (!publish_status(settings_.status)) {
    ++totals_.disk_failures;
    totals_.disk_is_failing = true;
  }
  if (totals_.disk_is_failing || was_failing) publish_in_memory();
  report_disk(totals_.disk_is_failing, &record);
}

/// Logs each trip and each clearance once.
void EventLog::report_trip(const CycleRecord& record) {
  if (std::exchange(was_tripped_, record.is_tripped) == record.is_tripped) return;
  char line[160];
  const int size = std::snprintf(line, sizeof line,
                                 "tripped: %s; the battery is released until bess-edge clear --yes",
                                 reason_name(record.trip.reason).data());
  write_journal_line(record.is_tripped ? JournalLevel::kError : JournalLevel::kNotice,
                     record.is_tripped ? std::string_view(line, static_cast<std::size_t>(size))
                                       : "cleared: control continues");
}

bool EventLog::append_to_run_ring(const CycleRecord& record, std::uint64_t number) {
  FileMessage ignored;
  const bool is_open =
      run_ring_.is_open() || run_ring_.open(settings_.run_ring.c_str(), kRunRecords, ignored);
  return is_open && run_ring_.append(record, number);
}

/// Opens a log that failed at the start again.
bool EventLog::append_to_ring(const CycleRecord& record, std::uint64_t number) {
  FileMessage ignored;
  if (ring_.is_open() && !ring_.is_at(settings_.ring.c_str()) && !follow_the_folder()) return false;
  return (ring_.is_open() || open_ring(ignored)) && catch_up(number) &&
         ring_.append(record, number);
}

/// Handles a changed state folder (unmounted, mounted, replaced). An empty folder, or a log of this
/// run, is continued. Another log may hold a trip, which the next start must read.
bool EventLog::follow_the_folder() {
  RingLog there;
  FileMessage ignored;
  CycleRecord newest;
  CycleRecord ours;
  const bool is_log = there.open_to_read(settings_.ring.c_str(), ignored) && there.newest(newest);
  const std::uint64_t number = there.newest_number();
  const bool is_known = is_log && (ring_.read(number, ours) || run_ring_.read(number, ours)) &&
                        ours.utc_s == newest.utc_s;
  if (is_log && !is_known) {
    if (std::exchange(is_ending_run_, true)) return false;
    write_journal_line(JournalLevel::kError,
                       "[state] folder now has another log (disk mounted late or replaced): this "
                       "run ends, the next start reads it");
    kill(getpid(), SIGTERM);
    return false;
  }
  write_journal_line(JournalLevel::kError,
                     is_log ? "[state] folder is back: its log continues"
                            : "the decision log is missing: was its disk unmounted? Starting a new "
                              "log");
  return open_ring(ignored);
}

/// Appends records that the disk refused, as far as the run folder still has them.
bool EventLog::catch_up(std::uint64_t number) {
  const std::uint64_t first = ring_.newest_number() + 1;
  if (first >= number) return true;
  std::uint64_t kept = 0;
  CycleRecord record;
  const bool has_memory = run_ring_.is_open();
  for (std::uint64_t n = std::max(first, run_ring_.oldest_number()); has_memory && n < number;
       ++n) {
    if (!run_ring_.read(n, record)) continue;
    if (!ring_.append(record, n)) return false;
    ++kept;
  }
  char text[160];
  TextBuffer line(text);
  line.add("the decision log continues: %llu missed records restored from memory, %llu lost",
           static_cast<unsigned long long>(kept),
           static_cast<unsigned long long>(number - first - kept));
  write_journal_line(JournalLevel::kWarning, line.view());
  return true;
}

bool EventLog::append_to_csv(const CycleRecord& record) {
  if (settings_.csv.empty()) return true;
  FileMessage ignored;
  if (csv_fd_ < 0 ? !open_csv(ignored) : !head_csv()) return false;
  char line[kLogLineBytes];
  return append_line(csv_fd_, line, format_csv_line(record, line));
}

/// Adds what the controller does during the disk failure.
void EventLog::add_present_state(const CycleRecord* record, TextBuffer& line) const {
  if (record == nullptr) {
    line.add("The next lines show whether the battery is controlled");
  } else if (record->is_tripped) {
    line.add("The battery stays released: tripped, %s", reason_name(record->trip.reason).data());
  } else if (!identity_.control) {
    line.add("Reading of the battery continues");
  } else if (record->mode == Mode::kRunning) {
    line.add("Control continues");
  } else {
    line.add("No control now: %s", reason_name(record->reason).data());
  }
}

/// Logs each begin and end of a disk failure once.
void EventLog::report_disk(bool is_failing, const CycleRecord* record) {
  if (std::exchange(was_failing_, is_failing) == is_failing) return;
  char text[256];
  TextBuffer line(text);
  if (is_failing) {
    line.add(
        "files of [state], [log] or [metrics] cannot be written: is the disk full or read-only? ");
    add_present_state(record, line);
  } else {
    line.add("files of [state], [log] and [metrics] are written again");
  }
  write_journal_line(JournalLevel::kWarning, line.view());
}

void EventLog::report_changes(const CycleRecord& record) {
  using AddLine = bool (ChangeLines::*)(const CycleRecord&, const RunIdentity&, TextBuffer&);
  const std::pair<AddLine, bool> lines[] = {
      {&ChangeLines::add_hold_line, record.hold.unreadable},
      {&ChangeLines::add_lost_line, record.measurement.lost_point != 0},
      {&ChangeLines::add_cut_line, true},
      {&ChangeLines::add_trust_line, record.site.trust.is_mismatch},
      {&ChangeLines::add_house_line, record.site.house_is_implausible}};
  for (const auto& [add_line, is_trouble] : lines) {
    char text[320];
    TextBuffer line(text);
    if (!(change_lines_.*add_line)(record, identity_, line)) continue;
    write_journal_line(is_trouble ? JournalLevel::kWarning : JournalLevel::kNotice, line.view());
  }
}

void EventLog::report_run_folder() {
  if (totals_.run_folder_is_failing == was_run_failing_) return;
  was_run_failing_ = totals_.run_folder_is_failing;
  write_journal_line(JournalLevel::kWarning,
                     was_run_failing_
                         ? "files of [state] run_folder cannot be written: check its permissions; "
                           "if the disk fails too, no status is available"
                         : "files of [state] run_folder are written again");
}

void EventLog::publish_in_memory() {
  if (settings_.run_ring.empty()) return;
  const bool has_metrics = publish_metrics(settings_.run_metrics.c_str());
  const bool has_status = publish_status(settings_.run_status);
  if (!has_metrics || !has_status) totals_.run_folder_is_failing = true;
}

bool EventLog::publish_metrics(const char* path) {
  TextBuffer metrics(metrics_text_);
  format_prometheus(stored_.status, metrics);
  return replace_or_remove_file(path, metrics.view());
}

bool EventLog::publish_status(const FixedText<511>& path) {
  stored_.status.written_monotonic_ms = clock_ns(CLOCK_MONOTONIC) / 1'000'000;
  const bool is_stored = write_status(stored_status_path(path).c_str(), stored_);
  const int error = errno;
  TextBuffer status(status_text_);
  format_status_json(stored_.status, status);
  const bool is_published = replace_or_remove_file(path.c_str(), status.view());
  if (!is_stored) errno = error;
  return is_stored && is_published;
}

}  // namespace bess
