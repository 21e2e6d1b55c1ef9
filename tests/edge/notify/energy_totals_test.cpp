// Counters that never go down: by hand, over restarts, gaps, stops, other rings and clocks that
// step.
#include "edge/notify/energy_totals.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

constexpr std::int64_t kTick = 1'679'875'320;  // on the grid of two minutes

CycleRecord record_at(std::int64_t utc_s, std::int32_t power_w) {
  CycleRecord record;
  record.utc_s = utc_s;
  record.mode = Mode::kRunning;
  record.has_measurement = true;
  record.measurement.power_w = power_w;
  return record;
}

class EnergyTotalsTest : public ::testing::Test {
 protected:
  EnergyTotalsTest() { open(100); }
  void open(std::int64_t capacity) {
    writer_ = std::make_unique<RingLog>();
    FileMessage error;
    ASSERT_TRUE(writer_->open(path_.c_str(), capacity, error)) << error.c_str();
  }
  void append(const CycleRecord& record) { ASSERT_TRUE(writer_->append(record)); }
  void append(int tick, std::int32_t power_w) { append(record_at(kTick + 120 * tick, power_w)); }
  void count(EnergyTotals& totals) const {
    LogReader log;
    FileMessage error;
    EventLogSettings places;
    places.ring.assign(path_);
    ASSERT_TRUE(log.open(places, error)) << error.c_str();
    totals.count_new(log);
  }

  TemporaryFolder folder_;
  std::string path_ = folder_.file("decisions.ring");
  std::unique_ptr<RingLog> writer_;
  EnergyTotals totals_;
};

TEST_F(EnergyTotalsTest, BeginAtTheFirstLookAndCountEachRecordOnce) {
  count(totals_);
  EXPECT_FALSE(totals_.has_begun());
  append(0, 4'000);
  count(totals_);
  EXPECT_TRUE(totals_.has_begun());
  EXPECT_EQ(totals_.charged_kwh(), 0);
  for (int tick = 1; tick <= 15; ++tick) append(tick, 4'000);
  for (int tick = 16; tick <= 30; ++tick) append(tick, -2'000);
  count(totals_);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 2);
  EXPECT_DOUBLE_EQ(totals_.discharged_kwh(), 1);
}

/// Counted in one go or by many runs of the notifier, and from a state that was kept an hour ago:
/// the same sums.
TEST_F(EnergyTotalsTest, AreTheSameWheneverTheyAreCounted) {
  append(0, 0);
  count(totals_);
  const EnergyTotals kept = totals_;
  EnergyTotals before = totals_;
  for (int tick = 1; tick <= 90; ++tick) {
    append(tick, tick % 7 * 500 - 1'500);
    count(totals_);
    EXPECT_GE(totals_.charged_ws, before.charged_ws);
    EXPECT_GE(totals_.discharged_ws, before.discharged_ws);
    before = totals_;
  }
  EnergyTotals late = kept;
  count(late);
  EXPECT_EQ(late.charged_ws, totals_.charged_ws);
  EXPECT_EQ(late.discharged_ws, totals_.discharged_ws);
}

TEST_F(EnergyTotalsTest, AGapOrAReadingThatIsMissingIsNotInvented) {
  append(0, 3'000);
  count(totals_);
  append(60, 3'000);  // two hours later: it stands for its two minutes
  CycleRecord blind = record_at(kTick + 120 * 61, 3'000);
  blind.has_measurement = false;
  append(blind);
  append(62, 3'000);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.2);
}

/// A stop writes a record that is no cycle, and a restart begins within the same two minutes.
TEST_F(EnergyTotalsTest, AStopAndARestartCountNoTimeTwice) {
  append(0, 3'000);
  count(totals_);
  append(1, 3'000);
  CycleRecord stopping = record_at(kTick + 150, 3'000);
  stopping.mode = Mode::kStopping;
  append(stopping);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.1);
  append(record_at(kTick + 180, 3'000));
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.15);
}

TEST_F(EnergyTotalsTest, WhatWasOverwrittenMeanwhileIsLeftOut) {
  append(0, 3'000);
  count(totals_);
  for (int tick = 1; tick <= 150; ++tick) append(tick, 3'000);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.1 * 100);
}

/// The log was set aside or lost: numbers begin anew, the sums go on.
TEST_F(EnergyTotalsTest, GoOnInAnotherRing) {
  append(0, 3'000);
  count(totals_);
  append(1, 3'000);
  count(totals_);
  std::filesystem::remove(path_);
  open(100);
  append(1, 9'000);  // was counted
  append(2, 3'000);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.2);
  std::filesystem::remove(path_);
  open(100);
  count(totals_);  // still empty
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.2);
}

TEST_F(EnergyTotalsTest, AClockThatWasInTheFutureSilencesNothing) {
  append(0, 3'000);
  count(totals_);
  append(record_at(kTick + 100'000'000, 3'000));
  count(totals_);
  append(1, 3'000);
  append(2, 3'000);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.2);  // the step itself and the tick behind it
  totals_.counted_utc_s += 100'000'000;          // and of a ring that is gone
  count(totals_);
  append(3, 3'000);
  count(totals_);
  EXPECT_DOUBLE_EQ(totals_.charged_kwh(), 0.3);
}

}  // namespace
}  // namespace bess
