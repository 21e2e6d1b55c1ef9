// Plan on day-ahead prices in integers: it never rises with SoC, is identical on every machine, for
// days of any length and any known prices.
#include "shared/outlook/outlook_plan.h"

#include <gtest/gtest.h>

#include "shared/crc32.h"
#include "shared/local_time.h"

namespace bess {
namespace {

constexpr std::int64_t kSecondsPerHour = 3600;

/// Deviations that fade by a half from step to step, prices that count fully.
OutlookModel any_model() {
  OutlookModel m;
  m.day_ahead_q12 = 1 << OutlookModel::kCoefficientBits;
  m.level_q12 = m.day_ahead_q12 / 4;
  m.lasting_q12 = m.day_ahead_q12 / 2;
  for (int q = 0; q < kQuarterHourCount; ++q) m.day_ahead_mean_centi[q] = 8000;
  constexpr std::int32_t kOne = 1 << OutlookModel::kProbabilityBits;
  constexpr int kBins = OutlookModel::kBins;
  for (int b = 0; b < kBins; ++b) m.bin_centi[b] = 1500 * (2 * b + 1 - kBins);
  for (int phase = 0; phase < OutlookModel::kPhases; ++phase) {
    for (int b = 0; b < kBins; ++b) {
      m.paid_centi[phase][b] = m.bin_centi[b];
      auto& row = m.transition_q15[phase][b];
      for (std::int32_t& share : row) share = kOne / 2 / kBins;
      row[b] += kOne - kBins * row[0];
    }
  }
  m.discount_q15 = kOne - 16;
  m.soc_min_e4 = 1000;
  m.soc_max_e4 = kSocFullE4;
  m.charge_q24 = m.discharge_q24 = (1 << OutlookModel::kEnergyBits) / 60;
  m.charge_points_q15 = 34'500;
  m.discharge_points_q15 = 38'400;
  return m;
}

/// All three days at this price.
OutlookDays flat_days(std::int64_t utc_s, std::int32_t centi) {
  OutlookDays days = outlook_days_around(utc_s);
  for (std::int64_t t = days.yesterday_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    days.day_ahead_centi[days.index_of(t)] = centi;
  }
  return days;
}

class OutlookPlanTest : public testing::Test {
 protected:
  OutlookPlanTest() { set_market_time_zone(); }

  const OutlookPlan& plan(const OutlookDays& days, std::int32_t level_centi = 8000) {
    plan_.make(model_, days, planned_level_centi(level_centi));
    return plan_;
  }
  [[nodiscard]] std::int32_t at(const OutlookPlan& made, std::int64_t utc_s, int soc_e4,
                                std::int32_t level_centi = 8000) const {
    return made.break_even_centi(model_, utc_s, soc_e4, level_centi);
  }

  OutlookModel model_ = any_model();
  OutlookPlan plan_;
  std::int64_t noon_utc_s_ = utc_from_civil({2025, 6, 11, 10, 0, 0});
};

TEST_F(OutlookPlanTest, TheModelIsSound) { EXPECT_TRUE(model_.is_sound()); }

TEST_F(OutlookPlanTest, AtFlatPricesItIsTheUsualPriceAndFallsWithSoc) {
  const OutlookPlan& flat = plan(flat_days(noon_utc_s_, 8000));
  const std::int32_t usual = 8000 + 8000 / 4;
  const std::int32_t half = at(flat, noon_utc_s_, 5500);
  EXPECT_NEAR(half, usual, 1500);
  EXPECT_GT(at(flat, noon_utc_s_, 1500), half + 500);
  EXPECT_LT(at(flat, noon_utc_s_, 9500), half - 500);
}

TEST_F(OutlookPlanTest, AHighEveningPriceRaisesTheBreakEvenPriceBeforeItOnly) {
  OutlookDays days = flat_days(noon_utc_s_, 8000);
  const std::int64_t evening = noon_utc_s_ + 7 * kSecondsPerHour;
  const std::int32_t before = at(plan(days), noon_utc_s_, 5500);
  const std::int32_t night = at(plan_, evening + 4 * kSecondsPerHour, 5500);
  for (int q = 0; q < 12; ++q) {
    days.day_ahead_centi[days.index_of(evening + q * kSecondsPerQuarterHour)] = 30'000;
  }
  EXPECT_GT(at(plan(days), noon_utc_s_, 5500), before + 1000);
  EXPECT_EQ(at(plan_, evening + 4 * kSecondsPerHour, 5500), night);
}

TEST_F(OutlookPlanTest, NeverRisesWithSocWhateverThePrices) {
  std::uint32_t draw = 7;
  const auto next = [&draw] { return draw = draw * 1'664'525 + 1'013'904'223; };
  for (int trial = 0; trial < 3; ++trial) {
    OutlookDays days = outlook_days_around(noon_utc_s_);
    for (std::int32_t& price : days.day_ahead_centi) {
      if (next() % 8 != 0) price = static_cast<std::int32_t>(next() % 60'000) - 20'000;
    }
    const OutlookPlan& made = plan(days, 12'345);
    for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerStep) {
      std::int32_t before = INT32_MAX;
      for (int soc = 0; soc < kSocCount; ++soc) {
        const std::int32_t now = at(made, t, soc * kSocE4PerLatticeStep, 12'345);
        ASSERT_LE(now, before) << soc;
        before = now;
      }
    }
  }
}

TEST_F(OutlookPlanTest, TheLevelOfTheMomentMovesItByItsSlope) {
  const OutlookPlan& made = plan(flat_days(noon_utc_s_, 8000), 8000);
  EXPECT_EQ(at(made, noon_utc_s_, 5500, 8400) - at(made, noon_utc_s_, 5500, 8000), 100);
}

TEST_F(OutlookPlanTest, LevelsArePlannedEvenlyBelowZeroToo) {
  EXPECT_EQ(planned_level_centi(0), 0);
  EXPECT_EQ(planned_level_centi(799), 0);
  EXPECT_EQ(planned_level_centi(800), 1600);
  EXPECT_EQ(planned_level_centi(-800), 0);
  EXPECT_EQ(planned_level_centi(-801), -1600);
}

// Where tomorrow is not published it is the mean by hour, moved by half of today's excess.
TEST_F(OutlookPlanTest, AnUnknownTomorrowIsTheMeanAndPartOfTodaysHeight) {
  OutlookDays unknown = flat_days(noon_utc_s_, 12'000);
  OutlookDays known = unknown;
  for (std::int64_t t = known.tomorrow_utc_s; t < known.end_utc_s; t += kSecondsPerQuarterHour) {
    unknown.day_ahead_centi[unknown.index_of(t)] = kDayAheadUnknown;
    known.day_ahead_centi[known.index_of(t)] = 8000 + (12'000 - 8000) / 2;
  }
  const std::int32_t expected = at(plan(known), noon_utc_s_, 3000);
  EXPECT_EQ(at(plan(unknown), noon_utc_s_, 3000), expected);
}

// 30 March has 23 hours and 26 October 25: the plan has exactly their steps.
TEST_F(OutlookPlanTest, DaysOfAnyLength) {
  const struct {
    CivilTime noon_utc;
    int steps;
  } cases[] = {{{2025, 3, 30, 12, 0, 0}, 690},
               {{2025, 6, 11, 12, 0, 0}, 720},
               {{2025, 10, 26, 12, 0, 0}, 750}};
  for (const auto& c : cases) {
    const OutlookDays days = flat_days(utc_from_civil(c.noon_utc), 8000);
    EXPECT_EQ(days.tomorrow_utc_s - days.today_utc_s, std::int64_t{c.steps} * kSecondsPerStep);
    const OutlookPlan& made = plan(days);
    EXPECT_FALSE(made.serves(days.today_utc_s - 1));
    EXPECT_TRUE(made.serves(days.today_utc_s));
    EXPECT_TRUE(made.serves(days.tomorrow_utc_s - 1));
    EXPECT_FALSE(made.serves(days.tomorrow_utc_s));
    EXPECT_NEAR(at(made, days.tomorrow_utc_s - kSecondsPerStep, 5500), 10'000, 1500);
  }
}

// Alternating extreme prices of a file: no integer overflows (sanitizers check), and the break-even
// price stays within its range.
TEST_F(OutlookPlanTest, ExtremePricesStayInside) {
  OutlookDays days = flat_days(noon_utc_s_, 0);
  for (std::size_t q = 0; q < std::size(days.day_ahead_centi); ++q) {
    days.day_ahead_centi[q] =
        (q / 8 % 2 == 0 ? 1 : -1) * kPlausiblePriceMaxEurPerMwh * kCentiPerEur;
  }
  const OutlookPlan& made = plan(days, 150'000);
  for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerStep) {
    EXPECT_LE(std::abs(at(made, t, 5500, 150'000)), 3'100'00);
  }
}

// One number for the clock changes of spring and autumn with gaps: every compiler, machine and
// instruction set must compute it.
TEST_F(OutlookPlanTest, IsTheSameToTheBitEverywhere) {
  Crc32 crc;
  for (const CivilTime& noon : {CivilTime{2025, 3, 29, 12, 0, 0}, CivilTime{2025, 3, 30, 12, 0, 0},
                                CivilTime{2025, 10, 26, 12, 0, 0}}) {
    OutlookDays days = outlook_days_around(utc_from_civil(noon));
    for (std::uint64_t q = 0; q < std::size(days.day_ahead_centi); ++q) {
      if (q % 17 != 0) {
        days.day_ahead_centi[q] = static_cast<std::int32_t>(q * q * 2'654'435'761U % 25'000) - 4000;
      }
    }
    const OutlookPlan& made = plan(days, 9876);
    for (std::int64_t t = days.today_utc_s; t < days.tomorrow_utc_s; t += kSecondsPerStep) {
      for (int soc_e4 = 0; soc_e4 <= kSocFullE4; soc_e4 += 850) {
        crc.add_integer(at(made, t, soc_e4, 9876));
      }
    }
  }
  EXPECT_EQ(crc.value(), 2559276767u);
}

TEST_F(OutlookPlanTest, NumbersThatNoFitLeadsToAreRefused) {
  const auto refused = [this](auto spoil) {
    OutlookModel model = model_;
    spoil(model);
    return !model.is_sound();
  };
  EXPECT_TRUE(refused([](OutlookModel& m) { m.transition_q15[3][4][5] += 1; }));
  EXPECT_TRUE(refused([](OutlookModel& m) {
    m.transition_q15[3][4][5] -= 40'000;
    m.transition_q15[3][4][6] += 40'000;
  }));
  EXPECT_TRUE(refused([](OutlookModel& m) { std::swap(m.bin_centi[0], m.bin_centi[1]); }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.paid_centi[14][23] = 2'000'001; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.hour_centi[95] = INT32_MIN; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.day_ahead_q12 = 1 << 16; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.charge_points_q15 = 0; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.discharge_q24 = 1 << 25; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.soc_max_e4 = m.soc_min_e4; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.discount_q15 = 40'000; }));
  EXPECT_TRUE(refused([](OutlookModel& m) { m.row_age_min = -1; }));
}

}  // namespace
}  // namespace bess
