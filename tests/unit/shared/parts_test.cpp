// Small shared parts: argmax, checksum, fixed-capacity vector and text, latches of the SoC, age of
// training days.
#include <gtest/gtest.h>

#include "edge/core/base/static_vector.h"
#include "shared/action.h"
#include "shared/crc32.h"
#include "shared/fixed_text.h"
#include "shared/soc_latches.h"
#include "shared/training_period.h"

namespace bess {
namespace {

TEST(Argmax, TiesGoToTheLowestAction) {
  const struct {
    int value[kActionCount];
    Action best;
  } cases[] = {
      {{0, 0, 0}, Action::kDischarge},    {{1, 1, 0}, Action::kDischarge},
      {{1, 0, 1}, Action::kDischarge},    {{0, 1, 1}, Action::kIdle},
      {{0, 0, 1}, Action::kCharge},       {{0, 1, 0}, Action::kIdle},
      {{-1, -2, -3}, Action::kDischarge}, {{INT32_MIN, INT32_MIN, INT32_MAX}, Action::kCharge},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(argmax_action(c.value), c.best)
        << c.value[0] << ' ' << c.value[1] << ' ' << c.value[2];
  }
}

TEST(Crc32, IntegersAreTheirLittleEndianBytes) {
  Crc32 integers;
  integers.add_integer(std::int32_t{-2});
  integers.add_integer(std::int16_t{0x0102});
  Crc32 bytes;
  for (const int byte : {0xFE, 0xFF, 0xFF, 0xFF, 0x02, 0x01}) {
    bytes.add_byte(static_cast<std::uint8_t>(byte));
  }
  EXPECT_EQ(integers.value(), bytes.value());
}

TEST(StaticVector, RefusesMoreThanItHolds) {
  StaticVector<int, 2> items;
  EXPECT_TRUE(items.try_push_back(1) && items.try_push_back(2));
  EXPECT_FALSE(items.try_push_back(3));
  EXPECT_EQ(items.size(), 2);
  EXPECT_EQ(items[1], 2);
  EXPECT_DEATH(items.push_back(3), "CHECK failed");
  EXPECT_DEATH(static_cast<void>(items[2]), "CHECK failed");
}

TEST(FixedText, CutsAndSaysSo) {
  FixedText<4> text;
  EXPECT_TRUE(text.assign("four"));
  EXPECT_FALSE(text.assign("fives"));
  EXPECT_EQ(text.view(), "five");
  EXPECT_EQ(text.c_str()[4], '\0');
}

TEST(SocLatches, OpenOnlySomeWayBackInside) {
  SocLatches soc{1'000, 10'000, 50};
  const struct {
    std::int32_t soc_e4;
    bool full, empty;
  } walk[] = {{9'999, false, false}, {10'000, true, false}, {9'950, true, false},
              {9'949, false, false}, {1'001, false, false}, {1'000, false, true},
              {1'050, false, true},  {1'051, false, false}};
  for (const auto& at : walk) {
    soc.update(at.soc_e4);
    EXPECT_EQ(soc.is_full, at.full) << at.soc_e4;
    EXPECT_EQ(soc.is_empty, at.empty) << at.soc_e4;
  }
}

/// 180 days of one price regime, and a day on either side of each boundary.
TEST(TrainingPeriod, IsReportedWhenItIsOldOrOfAnotherRegime) {
  const struct {
    const char *last, *today, *told;
  } cases[] = {
      {"2023-05-22", "2023-05-22", ""},
      {"2023-05-22", "2023-11-18", ""},
      {"2023-05-22", "2023-11-19", "181 days ago"},
      {"2024-05-20", "2024-05-21", ""},
      {"2024-05-21", "2024-05-22",
       "1 days ago, before the price regime from 22 May 2024 (dead band and floor, local mFRR)"},
      {"2024-05-22", "2024-05-23", ""},
      {"2024-11-25", "2024-11-26",
       "1 days ago, before the price regime from 26 November 2024 (PICASSO)"},
      {"2023-05-22", "2026-11-27",
       "1285 days ago, before the price regime from 1 October 2025 (day-ahead in quarter-hours)"},
      {"2025-10-01", "2025-12-31", ""},
      {"2023-05-22", "1970-01-01", ""},  // an unset clock
      {"", "2026-11-27", ""},
      {"2023-02-30", "2026-11-27", ""},
  };
  for (const auto& c : cases) {
    EXPECT_EQ(training_age_text({c.last, c.last}, c.today).view(), c.told)
        << c.last << ' ' << c.today;
  }
  EXPECT_TRUE(TrainingPeriod{}.is_sound());
  EXPECT_FALSE((TrainingPeriod{"2023-05-22", "2023-05-21"}.is_sound()));
  EXPECT_FALSE((TrainingPeriod{"2023-05-22", ""}.is_sound()));
}

}  // namespace
}  // namespace bess
