#include "edge/program/start_notes.h"

#include <cstdio>

#include "edge/control/policy.h"
#include "edge/prices/price_settings.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

std::string eur_text(std::int32_t centi) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f EUR/MWh", static_cast<double>(centi) / kCentiPerEur);
  return text;
}

std::string why_no_more(const LevelNews& news) {
  if (news.hours_wanted == 0) return "history_hours = 0";
  if (news.status == Status::kOk) return "the server has no more";
  return std::string(price_status_text(news.status));
}

std::string history_note(const LevelNews& news) {
  std::string text = "from " + std::to_string(news.rows) + " rows of the last " +
                     std::to_string(news.hours) + " h";
  if (news.hours >= news.hours_wanted) return text;
  return text + ", not " + std::to_string(news.hours_wanted) + " h: " + why_no_more(news);
}

std::string source_note(const LevelNews& news) {
  const std::string level = eur_text(news.start.level.centi_eur_per_mwh());
  switch (news.start.source) {
    case LevelSource::kLog:
      return level + ", from the decision log";
    case LevelSource::kHistory:
      return level + ", " + history_note(news);
    case LevelSource::kSetting:
      return level + ", from level_start_eur_per_mwh; no history: " + why_no_more(news);
    case LevelSource::kNone:
      break;
  }
  return "the first price will set it; no history: " + why_no_more(news);
}

}  // namespace

std::string context_note(const ContextClasses& context) {
  if (context.kind == ContextKind::kMonth) return "month";
  std::string text = context.is_outlook()
                         ? "break-even price of a plan on day-ahead prices, classes divided at"
                         : "trailing price level, classes divided at";
  const char* separator = " ";
  for (const std::int16_t edge : context.level_edge_eur_per_mwh) {
    text.append(separator).append(std::to_string(edge));
    separator = ", ";
  }
  return text + " EUR/MWh";
}

std::string level_note(const LevelNews& news) {
  const char* const refused = news.start.refused_log ? "the log's is out of range; " : "";
  return std::string("price level: ").append(refused).append(source_note(news));
}

JournalLevel journal_level_of(const LevelNews& news) {
  return news.start.source == LevelSource::kNone ? JournalLevel::kWarning : JournalLevel::kNotice;
}

namespace {

template <typename... Values>
void add_line(std::string& note, const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  note.append(line).append("\n");
}

}  // namespace

std::string operator_note(const ControlSettings& control, const Hold& hold,
                          std::int64_t now_utc_s) {
  std::string note;
  const HoldReport held = hold_at(hold, now_utc_s);
  if (held.held) {
    add_line(note, "hold       %d W until %s", held.power_w, utc_text(held.until_utc_s).c_str());
  }
  if (held.unreadable) add_line(note, "hold       %s", "its file is not readable: not followed");
  if (!control.reserve.empty()) {
    const std::int16_t now_e4 = reserve_soc_e4_at(control.reserve, local_minute_of(now_utc_s));
    add_line(note, "reserve    SoC %.1f %% at this hour, %d periods in all", now_e4 / 100.0,
             control.reserve.size());
  }
  for (int r = 0; r < guard_rule_count(); ++r) {
    add_line(note, "rule       %s", guard_rule_name(r));
  }
  if (control.full_charge_every_days > 0) {
    add_line(note, "full       every %d days, with %d W", control.full_charge_every_days,
             control.guard.full_charge_power_w);
  }
  return note;
}

namespace {

/// One threshold as both have it.
struct Pair {
  const char* key;
  const char* action;
  std::int32_t guard;
  std::int32_t proved;
  bool guard_reaches_further;  ///< it acts at prices at which the student need not
  bool binds_student;
};

const char* who_answers(const Pair& pair) {
  if (pair.guard_reaches_further) return "the guard alone makes it ";
  return pair.binds_student ? "the student's proof alone makes it " : "nothing makes it ";
}

void add_difference(const Pair& pair, std::string& text) {
  if (pair.guard == pair.proved) return;
  if (!text.empty()) text += "; ";
  text.append(pair.key).append(" = ").append(std::to_string(pair.guard));
  text.append(", the student is proved for ").append(std::to_string(pair.proved));
  text.append(": between them ").append(who_answers(pair)).append(pair.action);
}

std::string agreement(const PriceThresholds& both) {
  std::string text = "charge at or below " + std::to_string(both.low_eur_per_mwh);
  text.append(guard_alone_note(both.low_binds_student()));
  text.append(", discharge at or above ").append(std::to_string(both.high_eur_per_mwh));
  text.append(guard_alone_note(both.high_binds_student()));
  return text.append(" EUR/MWh, as the student is proved for");
}

}  // namespace

ThresholdNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved) {
  if (guard == proved) return {true, agreement(guard)};
  ThresholdNote note;
  add_difference(
      {"[guard] low_price_eur_per_mwh", "charge", guard.low_eur_per_mwh, proved.low_eur_per_mwh,
       guard.low_eur_per_mwh > proved.low_eur_per_mwh, proved.low_binds_student()},
      note.text);
  add_difference({"[guard] high_price_eur_per_mwh", "discharge", guard.high_eur_per_mwh,
                  proved.high_eur_per_mwh, guard.high_eur_per_mwh < proved.high_eur_per_mwh,
                  proved.high_binds_student()},
                 note.text);
  return note;
}

}  // namespace bess
