#include "edge/event_log.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>

#include "shared/utc_text.h"

namespace bess {
namespace {

void write_line(int fd, const char* text, std::size_t size) {
  char line[kLogLineBytes + 1];
  if (size > kLogLineBytes) size = kLogLineBytes;
  std::memcpy(line, text, size);
  line[size] = '\n';
  // A full disk or a closed pipe must not stop the controller: the line is lost, the battery is
  // not.
  const ssize_t ignored = ::write(fd, line, size + 1);
  static_cast<void>(ignored);
}

std::size_t bounded(int formatted) {
  if (formatted < 0) return 0;
  const auto size = static_cast<std::size_t>(formatted);
  return size < kLogLineBytes ? size : kLogLineBytes - 1;
}

const char* student_name(const CycleRecord& r) {
  return r.has_student_action ? action_name(r.student_action).data() : "none";
}

UtcText price_minute_text(const CycleRecord& r) {
  return r.price.has_row ? utc_text(r.price.minute_utc_s) : UtcText("none");
}

}  // namespace

std::size_t format_log_line(const CycleRecord& r, char (&line)[kLogLineBytes]) {
  return bounded(std::snprintf(
      line, sizeof line,
      "utc=%s cycle=%lld mode=%s price_centi=%d price_age_s=%d soc_e4=%d battery_power_w=%d "
      "student=%s ordered_power_w=%d reason=%s battery=%s prices=%s written=%d fetch_us=%d "
      "decision_us=%d write_us=%d total_us=%d missed_ticks=%d",
      utc_text(r.utc_s).c_str(), static_cast<long long>(r.cycle), mode_name(r.mode).data(),
      r.price.price_centi_eur_per_mwh, r.price_age_s, r.measurement.soc_e4, r.measurement.power_w,
      student_name(r), r.ordered_power_w, reason_name(r.reason).data(),
      status_name(r.battery_status).data(), status_name(r.price.status).data(), r.written,
      r.price.fetch_us, r.decision_us, r.write_us, r.total_us, r.missed_ticks));
}

const char* csv_header() {
  return "utc,cycle,mode,price_minute_utc,price_centi_eur_per_mwh,price_age_s,soc_e4,"
         "battery_power_w,student_action,ordered_power_w,reason,battery_status,price_status,"
         "written,"
         "fetch_us,decision_us,write_us,total_us,missed_ticks";
}

std::size_t format_csv_line(const CycleRecord& r, char (&line)[kLogLineBytes]) {
  return bounded(std::snprintf(
      line, sizeof line, "%s,%lld,%s,%s,%d,%d,%d,%d,%s,%d,%s,%s,%s,%d,%d,%d,%d,%d,%d",
      utc_text(r.utc_s).c_str(), static_cast<long long>(r.cycle), mode_name(r.mode).data(),
      price_minute_text(r).c_str(), r.price.price_centi_eur_per_mwh, r.price_age_s,
      r.measurement.soc_e4, r.measurement.power_w, student_name(r), r.ordered_power_w,
      reason_name(r.reason).data(), status_name(r.battery_status).data(),
      status_name(r.price.status).data(), r.written, r.price.fetch_us, r.decision_us, r.write_us,
      r.total_us, r.missed_ticks));
}

EventLog::~EventLog() {
  if (csv_fd_ >= 0) close(csv_fd_);
}

bool EventLog::open(const char* csv_path) {
  if (*csv_path == '\0') return true;
  csv_fd_ = ::open(csv_path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (csv_fd_ < 0) return false;
  struct stat info {};
  const bool is_empty = fstat(csv_fd_, &info) == 0 && info.st_size == 0;
  if (is_empty) write_line(csv_fd_, csv_header(), std::strlen(csv_header()));
  return true;
}

void EventLog::write(const CycleRecord& record) {
  char line[kLogLineBytes];
  write_line(STDOUT_FILENO, line, format_log_line(record, line));
  if (csv_fd_ >= 0) write_line(csv_fd_, line, format_csv_line(record, line));
}

void EventLog::note(const char* text) { write_line(STDOUT_FILENO, text, std::strlen(text)); }

}  // namespace bess
