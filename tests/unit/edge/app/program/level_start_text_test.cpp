// Journal text of the price level at the start, and the context in --check.
#include "edge/app/program/startup.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr PriceLevel kLevel{.centi_q16 = -8'420 * 65'536LL, .row_minute_utc_s = 60};

struct NoteCase {
  LevelStartReport level_report;
  const char* codes;
};

TEST(LevelNote, NamesTheSourceOfTheLevel) {
  using enum LevelSource;
  const NoteCase cases[] = {
      {{.start = {kLevel, kLog}, .hours_wanted = 72}, "-84.20"},
      {{.start = {kLevel, kHistory}, .hours_wanted = 72, .history = {.hours = 72, .rows = 4'312}},
       "-84.20 4312 72"},
      {{.start = {kLevel, kHistory}, .hours_wanted = 72, .history = {.hours = 7, .rows = 400}},
       "-84.20 400 7 72"},
      {{.start = {kLevel, kHistory},
        .hours_wanted = 72,
        .history = {.hours = 40, .rows = 2'400, .status = Status::kTimeout}},
       "-84.20 2400 40 72"},
      {{.start = {kLevel, kSetting}}, "-84.20 level_start_eur_per_mwh history_hours"},
      {{.hours_wanted = 0}, "history_hours"},
      {{.start = {.level = kLevel, .source = kSetting, .refused_log = true}},
       "-84.20 level_start_eur_per_mwh history_hours"},
  };
  std::set<std::string> notes;
  for (const NoteCase& c : cases) {
    const std::string note(level_start_text(c.level_report));
    EXPECT_THAT(note, Names(c.codes));
    EXPECT_TRUE(notes.insert(note).second) << note;
    EXPECT_EQ(journal_level_of(c.level_report) == JournalLevel::kWarning,
              c.level_report.start.source == kNone);
  }
}

TEST(ContextNote, NamesMonthOrEdges) {
  EXPECT_EQ(context_note(ContextClasses{}), "month");
  ContextClasses classes{.kind = ContextKind::kLevel};
  for (int i = 0; i < kContextClassCount - 1; ++i) {
    classes.level_edge_eur_per_mwh[i] = static_cast<std::int16_t>(10 * i - 20);
  }
  EXPECT_THAT(context_note(classes), Names("-20 -10 0 10 20 30 40 50 60 70 80 EUR/MWh"));
}

}  // namespace
}  // namespace bess
