#include "edge/program/level_note.h"

#include <cstdio>

#include "edge/prices/price_settings.h"
#include "shared/units_and_limits.h"

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

}  // namespace bess
