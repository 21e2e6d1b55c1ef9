// Price level at a start: accepted log values, the request when the log has none, and no request of
// a student by month.
#include "edge/core/control/level_start.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

constexpr std::int64_t kStartUtcS = 1'679'788'890;  // 2023-03-26T00:01:30Z
constexpr std::int64_t kNewestRow = 1'679'788'800;
constexpr PriceLevel kLogged{.centi_q16 = 8'420 * 65'536LL,
                             .row_minute_utc_s = kStartUtcS - 86'400};
constexpr PriceLevel kPast{.centi_q16 = 7'000 * 65'536LL, .row_minute_utc_s = kNewestRow - 60};

struct StartCase {
  const char* name;
  ContextKind kind;
  PriceLevel logged, past;
  std::optional<std::int32_t> setting;
  LevelStart start;
  bool asks;
};

TEST(LevelStart, LogThenHistoryThenSettingThenTheFirstPrice) {
  constexpr ContextKind kMonth = ContextKind::kMonth;
  constexpr ContextKind kLevel = ContextKind::kLevel;
  const PriceLevel set = PriceLevel::starting_at(9'000);
  const PriceLevel foreign{.centi_q16 = INT64_MAX, .row_minute_utc_s = kStartUtcS - 120};
  const StartCase cases[] = {
      {"kept", kLevel, kLogged, kPast, 9'000, {kLogged, LevelSource::kLog}, false},
      {"kept by month too", kMonth, kLogged, kPast, 9'000, {kLogged, LevelSource::kLog}, false},
      {"fetched", kLevel, {}, kPast, 9'000, {kPast, LevelSource::kHistory}, true},
      {"set", kLevel, {}, {}, 9'000, {set, LevelSource::kSetting}, true},
      {"nothing", kLevel, {}, {}, {}, {{}, LevelSource::kNone}, true},
      {"by month", kMonth, {}, kPast, 9'000, {{}, LevelSource::kNone}, false},
      {"refused", kLevel, foreign, kPast, {}, {kPast, LevelSource::kHistory, true}, true},
      {"refused by month", kMonth, foreign, kPast, {}, {{}, LevelSource::kNone, true}, false},
  };
  for (const StartCase& c : cases) {
    SCOPED_TRACE(c.name);
    int asked = 0;
    const LevelStart start = find_start_level(c.kind, c.logged, kStartUtcS, c.setting, [&] {
      ++asked;
      return c.past;
    });
    EXPECT_EQ(start.level, c.start.level);
    EXPECT_EQ(start.source, c.start.source);
    EXPECT_EQ(start.refused_log, c.start.refused_log);
    EXPECT_EQ(asked, c.asks ? 1 : 0);
  }
}

/// Logged while the clock was a year ahead: without the bound no row would count for a year.
TEST(LevelFromLog, ARowOfTheFutureDoesNotFreezeTheLevel) {
  for (const std::int64_t row :
       {kStartUtcS + std::int64_t{365} * 86'400, kStartUtcS + 60, std::int64_t{INT64_MAX}}) {
    PriceLevel level =
        level_from_log({.centi_q16 = kLogged.centi_q16, .row_minute_utc_s = row}, kStartUtcS);
    EXPECT_EQ(level.centi_q16, kLogged.centi_q16);
    EXPECT_EQ(level.row_minute_utc_s, kNewestRow);
    level.observe(kNewestRow + 60, 8'420 + 720);  // the row of the next tick's minute counts
    EXPECT_EQ(level.centi_eur_per_mwh(), 8'421);
  }
}

/// A machine without a battery-backed clock starts in 1970: the level stays, and rows count once
/// the time is set.
TEST(LevelFromLog, AClockInThePastKeepsTheLevel) {
  for (const std::int64_t now : {0, 30, 90, 600}) {  // seconds since 1970
    PriceLevel level = level_from_log(kLogged, now);
    EXPECT_TRUE(level.is_known()) << now;
    EXPECT_EQ(level.centi_q16, kLogged.centi_q16);
    level.observe(kNewestRow, 8'420 + 720);
    EXPECT_EQ(level.centi_eur_per_mwh(), 8'421);
  }
}

}  // namespace
}  // namespace bess
