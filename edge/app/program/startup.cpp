#include "edge/app/program/startup.h"

#include <signal.h>
#include <sys/prctl.h>

#include "edge/core/control/decision_signature.h"
#include "edge/core/control/policy.h"
#include "edge/prices/record/price_settings.h"
#include "edge/records/log/journal.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

bool check_student() {
  set_market_time_zone();  // one check plans local days
  const int failures = count_student_self_check_failures();
  if (failures == 0) return true;
  report(JournalLevel::kError,
         "the built-in student fails %d of %d self-checks on this machine: rebuild bess-edge for "
         "it",
         failures, student_self_check_count());
  return false;
}

bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock) {
  const BatterySearch found = find_battery(config, battery, clock);
  if (found.status == Status::kOk) return true;
  report(JournalLevel::kError, "battery at %s", found.trouble.c_str());
  return false;
}

std::string decision_signature_line() {
  set_market_time_zone();
  return signature_line(student_hash(), replay_recorded_days()).c_str();
}

void prepare_process() {
  set_market_time_zone();
  signal(SIGPIPE, SIG_IGN);           // a closed log reader must not end the controller
  prctl(PR_SET_TIMERSLACK, 1'000UL);  // ns; the default 50 us matters at high time scales
}

namespace {

std::string eur_text(std::int32_t centi) {
  return formatted("%.2f EUR/MWh", static_cast<double>(centi) / kCentiPerEur);
}

std::string why_no_more(const LevelStartReport& level_report) {
  if (level_report.hours_wanted == 0) return "history_hours = 0";
  if (level_report.history.status == Status::kOk) return "no more rows at the server";
  return std::string(price_status_text(level_report.history.status));
}

std::string history_note(const LevelStartReport& level_report) {
  std::string text = "from " + std::to_string(level_report.history.rows) + " rows of the last " +
                     std::to_string(level_report.history.hours) + " h";
  if (level_report.history.hours >= level_report.hours_wanted) return text;
  return text + " instead of " + std::to_string(level_report.hours_wanted) +
         " h: " + why_no_more(level_report);
}

std::string source_note(const LevelStartReport& level_report) {
  const std::string level = eur_text(level_report.start.level.centi_eur_per_mwh());
  const LevelSource source = level_report.start.source;
  if (source == LevelSource::kLog) return level + ", from the decision log";
  if (source == LevelSource::kHistory) return level + ", " + history_note(level_report);
  if (source == LevelSource::kSetting) {
    return level + ", from level_start_eur_per_mwh; no history: " + why_no_more(level_report);
  }
  return "set by the first price; no history: " + why_no_more(level_report);
}

}  // namespace

std::string context_note(const ContextClasses& context) {
  if (context.kind == ContextKind::kMonth) return "month";
  std::string text = context.is_outlook()
                         ? "break-even price of the plan on day-ahead prices, class limits"
                         : "trailing price level, class limits";
  const char* separator = " ";
  for (const std::int16_t edge : context.level_edge_eur_per_mwh) {
    text.append(separator).append(std::to_string(edge));
    separator = ", ";
  }
  return text + " EUR/MWh";
}

std::string level_start_text(const LevelStartReport& level_report) {
  const char* const refused =
      level_report.start.refused_log ? "value in the log out of range; " : "";
  return std::string("price level: ").append(refused).append(source_note(level_report));
}

JournalLevel journal_level_of(const LevelStartReport& level_report) {
  return level_report.start.source == LevelSource::kNone ? JournalLevel::kWarning
                                                         : JournalLevel::kNotice;
}

std::string operator_note(const ControlSettings& control, const Hold& hold,
                          std::int64_t now_utc_s) {
  std::string note;
  const HoldReport held = hold_at(hold, now_utc_s);
  if (held.held) {
    add_formatted(note, "hold       %d W until %s\n", held.power_w,
                  utc_text(held.until_utc_s).c_str());
  }
  if (held.unreadable) note += "hold       file unreadable, hold ignored\n";
  if (!control.reserve.empty()) {
    const std::int16_t now_e4 = reserve_soc_e4_at(control.reserve, local_minute_of(now_utc_s));
    add_formatted(note, "reserve    SoC %.1f %% at this hour, %d periods in total\n",
                  now_e4 / 100.0, control.reserve.size());
  }
  for (int r = 0; r < guard_rule_count(); ++r) {
    add_formatted(note, "rule       %s\n", guard_rule_name(r));
  }
  if (control.full_charge_every_days > 0) {
    add_formatted(note, "full       every %d days, with %d W\n", control.full_charge_every_days,
                  control.guard.full_charge_power_w());
  }
  return note;
}

namespace {

/// Text of a threshold in which guard and student differ; empty: equal. `guard_acts_further`: it
/// acts at prices not proved for the student.
std::string difference_text(const char* key, const char* action, std::int32_t guard,
                            std::int32_t proved, bool guard_acts_further, bool binds_student) {
  if (guard == proved) return "";
  const char* const who = guard_acts_further ? "only the guard makes it"
                          : binds_student    ? "only the student's proof makes it"
                                             : "nothing makes it";
  return formatted("[guard] %s = %d, the student is proved for %d: between them %s %s", key, guard,
                   proved, who, action);
}

}  // namespace

SettingsNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved) {
  if (guard == proved) {
    return {.text = formatted(
                "charge at or below %d%s, discharge at or above %d%s EUR/MWh, as the "
                "student is proved for",
                guard.low_eur_per_mwh, guard_alone_note(guard.low_binds_student()).data(),
                guard.high_eur_per_mwh, guard_alone_note(guard.high_binds_student()).data())};
  }
  const std::string low = difference_text(
      "low_price_eur_per_mwh", "charge", guard.low_eur_per_mwh, proved.low_eur_per_mwh,
      guard.low_eur_per_mwh > proved.low_eur_per_mwh, proved.low_binds_student());
  const std::string high = difference_text(
      "high_price_eur_per_mwh", "discharge", guard.high_eur_per_mwh, proved.high_eur_per_mwh,
      guard.high_eur_per_mwh < proved.high_eur_per_mwh, proved.high_binds_student());
  return {.is_warning = true, .text = low + (low.empty() || high.empty() ? "" : "; ") + high};
}

}  // namespace bess
