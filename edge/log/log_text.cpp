#include "edge/log/log_text.h"

#include <cstdio>

#include "shared/utc_text.h"

namespace bess {
namespace {

std::size_t bounded(int formatted) {
  if (formatted < 0) return 0;
  const auto size = static_cast<std::size_t>(formatted);
  return size < kLogLineBytes ? size : kLogLineBytes - 1;
}

long long as_long(std::int64_t value) { return value; }

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
      "decision_us=%d write_us=%d total_us=%d missed_ticks=%d deadline_misses=%d",
      utc_text(r.utc_s).c_str(), as_long(r.cycle), mode_name(r.mode).data(),
      r.price.price_centi_eur_per_mwh, r.price_age_s, r.measurement.soc_e4, r.measurement.power_w,
      student_name(r), r.ordered_power_w, reason_name(r.reason).data(),
      status_name(r.battery_status).data(), status_name(r.price.status).data(), r.written,
      r.price.fetch_us, r.decision_us, r.write_us, r.total_us, r.missed_ticks, r.deadline_misses));
}

const char* csv_header() {
  return "utc,cycle,mode,price_minute_utc,price_centi_eur_per_mwh,price_age_s,soc_e4,"
         "battery_power_w,student_action,ordered_power_w,reason,battery_status,price_status,"
         "written,fetch_us,decision_us,write_us,total_us,missed_ticks,large_step,requests,"
         "failed_requests,reconnects,register_writes,unchanged_orders,flash_writes_today,"
         "deadline_misses,unanswered_orders,soc_moved_e4";
}

std::size_t format_csv_line(const CycleRecord& r, char (&line)[kLogLineBytes]) {
  const BatteryCounters& c = r.counters;
  return bounded(std::snprintf(
      line, sizeof line,
      "%s,%lld,%s,%s,%d,%d,%d,%d,%s,%d,%s,%s,%s,%d,%d,%d,%d,%d,%d,%d,%lld,%lld,%lld,%lld,%lld,%d,"
      "%d,%d,%d",
      utc_text(r.utc_s).c_str(), as_long(r.cycle), mode_name(r.mode).data(),
      price_minute_text(r).c_str(), r.price.price_centi_eur_per_mwh, r.price_age_s,
      r.measurement.soc_e4, r.measurement.power_w, student_name(r), r.ordered_power_w,
      reason_name(r.reason).data(), status_name(r.battery_status).data(),
      status_name(r.price.status).data(), r.written, r.price.fetch_us, r.decision_us, r.write_us,
      r.total_us, r.missed_ticks, r.price.large_step, as_long(c.requests),
      as_long(c.failed_requests), as_long(c.reconnects), as_long(c.register_writes),
      as_long(c.unchanged_orders), c.flash_writes_today, r.deadline_misses, r.unanswered_orders,
      r.throughput.soc_moved_e4));
}

}  // namespace bess
