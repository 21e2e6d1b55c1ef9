// Results of the planning thread, and their use in a control cycle when the thread is in time,
// late, or dead.
#include "edge/prices/fetch/outlook_fetcher.h"

#include <gtest/gtest.h>

#include <memory>

#include "edge/core/control/policy.h"
#include "shared/local_time.h"
#include "shared/outlook/outlook_plan.h"
#include "tests/support/market_zone.h"

namespace bess {
namespace {

class Planner : public InMarketZone, public testing::Test {
 protected:
  int plan(std::int64_t tick, std::int32_t level_centi, const OutlookDays& days) {
    return planner_->plan({.tick_utc_s = tick, .level_centi = level_centi}, days);
  }
  OutlookReport at(std::int64_t tick, std::int32_t level_centi, std::int32_t soc_e4 = 4'000) {
    return outlook_at(*exchange_, tick, soc_e4, level_centi);
  }
  /// A plan of the days and level, cached until others are requested.
  std::int32_t direct(std::int64_t tick, std::int32_t level_centi, const OutlookDays& days,
                      std::int32_t soc_e4 = 4'000) {
    if (planned_for_ != planned_level_centi(level_centi) || planned_days_ != days) {
      planned_for_ = planned_level_centi(level_centi);
      planned_days_ = days;
      plan_->make(*student_outlook(), days, planned_for_);
    }
    return plan_->break_even_centi(*student_outlook(), tick, soc_e4, level_centi);
  }

  std::int64_t tick_ = utc_from_civil({2025, 6, 11, 10, 2, 0});
  OutlookDays days_ = made_up_outlook_days(tick_);
  std::unique_ptr<OutlookExchange> exchange_ = std::make_unique<OutlookExchange>();
  std::unique_ptr<OutlookPlanner> planner_ =
      std::make_unique<OutlookPlanner>(*student_outlook(), *exchange_);
  std::unique_ptr<OutlookPlan> plan_ = std::make_unique<OutlookPlan>();
  OutlookDays planned_days_{};
  std::int32_t planned_for_ = INT32_MIN;
};

TEST_F(Planner, OffersWhatThePlanItselfSays) {
  for (const std::int32_t level : {8'000, 8'790, 8'810, -2'000}) {
    plan(tick_, level, days_);
    for (const std::int32_t moved : {-270, 0, 270}) {
      const OutlookReport found = at(tick_, level + moved);
      EXPECT_EQ(found.source, OutlookSource::kPlanned);
      EXPECT_EQ(found.break_even_centi, direct(tick_, level + moved, days_));
    }
  }
}

TEST_F(Planner, MakesNoPlanTwice) {
  EXPECT_EQ(plan(tick_, 8'000, days_), 1);
  EXPECT_EQ(plan(tick_ + 120, 8'010, days_), 0);
  EXPECT_EQ(plan(tick_ + 240, 8'700, days_), 1);  // near the edge at 88: both neighbours
  EXPECT_EQ(plan(tick_ + 360, 8'900, days_), 0);
  EXPECT_EQ(plan(tick_ + 480, 8'700, days_), 0);
  OutlookDays more = days_;
  more.day_ahead_centi[200] += 1;
  EXPECT_EQ(plan(tick_ + 600, 8'000, more), 1);
}

TEST_F(Planner, LateItServesHalfAnHourAndThenTheUsualDay) {
  planner_->plan_usual_day(tick_, 8'000);
  plan(tick_, 8'000, days_);
  for (int k = 1; k < OutlookPlanRows::kTicks; ++k) {
    const OutlookReport found = at(tick_ + k * kSecondsPerStep, 8'000);
    EXPECT_EQ(found.source, OutlookSource::kLate);
    EXPECT_EQ(found.break_even_centi, direct(tick_ + k * kSecondsPerStep, 8'000, days_));
  }
  for (const std::int64_t off : {OutlookPlanRows::kTicks * kSecondsPerStep, 86'400, -120, 60}) {
    const OutlookReport found = at(tick_ + off, 8'000);
    EXPECT_EQ(found.source, OutlookSource::kMissing) << off;
    EXPECT_NEAR(found.break_even_centi,
                direct(tick_ - tick_ % 900, 8'000, outlook_days_around(tick_)), 4'000);
  }
}

TEST_F(Planner, TheUsualDayIsAPlanOfNothingPublished) {
  planner_->plan_usual_day(tick_, 8'000);
  const OutlookDays none = outlook_days_around(tick_);
  for (std::int64_t t = none.today_utc_s; t < none.tomorrow_utc_s; t += 3 * kSecondsPerStep) {
    const std::int64_t quarter = t - t % kSecondsPerQuarterHour;
    EXPECT_EQ(at(t + 7 * 86'400, 8'123).break_even_centi, direct(quarter, 8'123, none));
  }
}

/// On the first day of summer time, the skipped hour has the row of the next.
TEST_F(Planner, TheUsualDayHasEveryQuarterHourWhateverDayItWasMadeOn) {
  for (const CivilTime day : {CivilTime{2025, 3, 30, 8, 0, 0}, CivilTime{2025, 10, 26, 8, 0, 0}}) {
    planner_->plan_usual_day(utc_from_civil(day), 8'000);
    for (const BreakEvenRow& row : exchange_->usual.rows) {
      EXPECT_NE(row.tenths[OutlookModel::kSocPoints / 2], 0);
    }
  }
}

TEST_F(Planner, ALevelThatJumpedIsLateAndMovedBySlope) {
  plan(tick_, 8'000, days_);
  const OutlookReport found = at(tick_, 15'000);
  EXPECT_EQ(found.source, OutlookSource::kLate);
  const std::int32_t moved_centi = student_outlook()->level_q12 * 7'000 >> 12;
  EXPECT_NEAR(found.break_even_centi, direct(tick_, 8'000, days_) + moved_centi, 2);
}

TEST_F(Planner, NothingIsOfferedBeyondMidnight) {
  const std::int64_t before_midnight = days_.tomorrow_utc_s - 2 * kSecondsPerStep;
  plan(before_midnight, 8'000, days_);
  EXPECT_EQ(at(days_.tomorrow_utc_s - kSecondsPerStep, 8'000).source, OutlookSource::kLate);
  EXPECT_EQ(at(days_.tomorrow_utc_s, 8'000).source, OutlookSource::kMissing);
}

TEST_F(Planner, ReportsPublishedPricesAndTheirMaximum) {
  plan(tick_, 8'000, days_);
  const OutlookReport found = at(tick_, 8'000);
  int known = 0;
  std::int32_t dearest = INT32_MIN;
  std::int32_t cheapest = INT32_MAX;
  for (std::int64_t t = tick_ - tick_ % 900; t < days_.end_utc_s; t += kSecondsPerQuarterHour) {
    const std::int32_t centi = days_.day_ahead_centi[days_.index_of(t)];
    if (centi == kDayAheadUnknown) continue;
    ++known;
    dearest = std::max(dearest, centi);
    cheapest = std::min(cheapest, centi);
  }
  EXPECT_EQ(found.known_quarter_hours, known);
  EXPECT_EQ(found.dearest.centi_eur_per_mwh, dearest);
  EXPECT_EQ(found.cheapest.centi_eur_per_mwh, cheapest);
  EXPECT_EQ(days_.day_ahead_centi[days_.index_of(found.dearest.utc_s)], dearest);
  plan(tick_, 8'000, outlook_days_around(tick_));
  EXPECT_EQ(at(tick_, 8'000).source, OutlookSource::kUsual);
  EXPECT_EQ(at(tick_, 8'000).known_quarter_hours, 0);
}

}  // namespace
}  // namespace bess
