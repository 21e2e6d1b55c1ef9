// What the journal says of the price level at the start, and what --check says of the context.
#include "edge/program/level_note.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr PriceLevel kLevel{.centi_q16 = -8'420 * 65'536LL, .row_minute_utc_s = 60};

struct NoteCase {
  const char* name;
  LevelNews news;
  const char* text;
};

TEST(LevelNote, SaysHowTheLevelWasComeBy) {
  const NoteCase cases[] = {
      {"log",
       {.start = {kLevel, LevelSource::kLog}, .hours_wanted = 72},
       "price level: -84.20 EUR/MWh, from the decision log"},
      {"history",
       {.start = {kLevel, LevelSource::kHistory}, .hours_wanted = 72, .hours = 72, .rows = 4'312},
       "price level: -84.20 EUR/MWh, from 4312 rows of the last 72 h"},
      {"the server has less",
       {.start = {kLevel, LevelSource::kHistory}, .hours_wanted = 72, .hours = 7, .rows = 400},
       "price level: -84.20 EUR/MWh, from 400 rows of the last 7 h, not 72 h: the server has no "
       "more"},
      {"the time was over",
       {.start = {kLevel, LevelSource::kHistory},
        .hours_wanted = 72,
        .hours = 40,
        .rows = 2'400,
        .status = Status::kTimeout},
       "price level: -84.20 EUR/MWh, from 2400 rows of the last 40 h, not 72 h: no complete answer "
       "in time (see timeout_ms)"},
      {"set",
       {.start = {kLevel, LevelSource::kSetting}},
       "price level: -84.20 EUR/MWh, from level_start_eur_per_mwh; no history: history_hours = 0"},
      {"nothing",
       {.hours_wanted = 72},
       "price level: the first price will set it; no history: the server has no more"},
      {"refused",
       {.start = {.level = kLevel, .source = LevelSource::kSetting, .refused_log = true}},
       "price level: the log's is out of range; -84.20 EUR/MWh, from level_start_eur_per_mwh; no "
       "history: history_hours = 0"},
  };
  for (const NoteCase& c : cases) {
    SCOPED_TRACE(c.name);
    EXPECT_EQ(level_note(c.news), c.text);
    const bool is_warning = journal_level_of(c.news) == JournalLevel::kWarning;
    EXPECT_EQ(is_warning, c.news.start.source == LevelSource::kNone);
  }
}

TEST(ContextNote, NamesMonthOrEdges) {
  EXPECT_EQ(context_note(ContextClasses{}), "month");
  ContextClasses classes{.kind = ContextKind::kLevel};
  for (int i = 0; i < kContextClassCount - 1; ++i) {
    classes.level_edge_eur_per_mwh[i] = static_cast<std::int16_t>(10 * i - 20);
  }
  EXPECT_EQ(context_note(classes),
            "trailing price level, classes divided at -20, -10, 0, 10, 20, 30, 40, 50, 60, 70, 80 "
            "EUR/MWh");
}

}  // namespace
}  // namespace bess
