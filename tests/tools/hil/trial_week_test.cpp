// The trial week: paired losses, and a week of the yardstick with everything on.
#include "tools/hil_runner/run/trial_week.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/host/user_error.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(TrialWeek, ALossIsPairedWeekByWeek) {
  std::vector<TrialWeek> weeks(4);
  const double plain[] = {40, 60, 50, 50};
  const double lost[] = {2, 3, 2, 3};
  for (std::size_t i = 0; i < weeks.size(); ++i) {
    weeks[i].plain_eur = plain[i];
    weeks[i].loop_eur[1] = plain[i] - lost[i];
  }
  const TrialLoss loss = loss_of(weeks, 1);
  EXPECT_NEAR(loss.percent, 5.0, 1e-9);
  // The differences' own spread, 1/3, and not that of the weeks.
  EXPECT_NEAR(loss.percent_error, 100 * std::sqrt((1.0 / 3) / 4) / 50, 1e-9);
}

TEST(TrialWeek, TheLoopCostsLittleAndEverythingTogetherCostsMore) {
  const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  int told = 0;
  const std::vector<TrialWeek> weeks = run_trial(prices, 1, {}, [&](int, int) { ++told; });
  ASSERT_EQ(weeks.size(), 1U);
  EXPECT_EQ(told, 1);
  EXPECT_GT(weeks[0].plain_eur, 10);
  for (const Finding& f : weeks[0].findings)
    ADD_FAILURE() << f.rule << " " << f.expected << " " << f.seen;
  EXPECT_NEAR(loss_of(weeks, 0).percent, 0, 2) << "the loop alone";
  EXPECT_GT(loss_of(weeks, kDisturbanceCount - 1).percent, loss_of(weeks, 0).percent);
}

TEST(TrialWeek, TheModelOfABatteryAsItIsSaysWhatItsLoopEarns) {
  const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  BatteryParameters real = paper_house();
  real.charge_taper = {.width_frac = 0.12, .share = 0.25};
  real.discharge_taper = {.width_frac = 0.06, .share = 0.4};
  real.full_power_loss_frac = 0.03;
  real.standby_w = 35;
  real.response.time_constant_s = 3;
  TrialHouse house;
  house.physics = real;
  const auto ignored = [](int, int) {};
  const TrialWeek paper = run_trial(prices, 1, {}, ignored)[0];
  const TrialWeek week = run_trial(prices, 1, house, ignored)[0];
  for (const Finding& f : week.findings) ADD_FAILURE() << f.rule << ' ' << f.expected;
  EXPECT_LT(week.plain_eur, 0.97 * paper.plain_eur);
  EXPECT_NEAR(loss_of({week}, 0).percent, 0, 2) << "the loop alone";
}

TEST(TrialWeek, AnOldPriceThatStandsInIsJudgedAsEveryOther) {
  const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  TrialHouse house;
  house.outage_min = 20;
  house.outage_every_min = 120;
  house.edge_guard = "stand_in_s_max = 1800";
  const TrialWeek week = run_trial(prices, 1, house, [](int, int) {})[0];
  for (const Finding& f : week.findings) ADD_FAILURE() << f.rule << ' ' << f.expected;
  EXPECT_GT(loss_of({week}, 3).percent, loss_of({week}, 0).percent) << disturbances()[3].text;
}

TEST(TrialWeek, ColdHoursThatTheBatteryKnowsAreNoLossOfTheLoop) {
  const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  TrialHouse house;
  house.physics.cold = {.power_share = 0.6, .from_hour = 2, .to_hour = 7};
  const TrialWeek week = run_trial(prices, 1, house, [](int, int) {})[0];
  for (const Finding& f : week.findings) ADD_FAILURE() << f.rule << ' ' << f.expected;
  EXPECT_NEAR(loss_of({week}, 0).percent, 0, 2) << "the loop alone";
  EXPECT_EQ(week.loop_eur[4], week.loop_eur[0]) << "they are not switched on once more";
}

TEST(TrialWeek, MoreWeeksThanTheFileHoldsAreRefused) {
  const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  try {
    static_cast<void>(run_trial(prices, 100, {}, [](int, int) {}));
    FAIL() << "they were taken";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), Names("17 8 100"));
  }
}

}  // namespace
}  // namespace bess
