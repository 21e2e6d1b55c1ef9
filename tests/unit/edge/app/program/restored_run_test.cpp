// State restored from the log at the start: which control cycles, in which order, and the age of an
// order.
#include "edge/app/program/restored_run.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace bess {
namespace {

constexpr std::int64_t kNowUtcS = 1'700'000'040;

/// The newest last.
struct MadeUpLog {
  std::vector<CycleRecord> records;
  std::set<std::int64_t> unreadable;  ///< records ago
  mutable std::int64_t reads = 0;

  bool read_back(std::int64_t records_ago, CycleRecord& record) const {
    ++reads;
    if (records_ago >= std::ssize(records) || unreadable.contains(records_ago)) return false;
    record = records[records.size() - 1 - static_cast<std::size_t>(records_ago)];
    return true;
  }
  /// One every two minutes, the newest 1 min old.
  explicit MadeUpLog(std::int64_t count) {
    for (std::int64_t i = count - 1; i >= 0; --i) {
      CycleRecord record;
      record.utc_s = kNowUtcS - 60 - i * kSecondsPerStep;
      record.cycle = count - i;
      records.push_back(record);
    }
  }
};

struct NotedLoop {
  std::vector<std::int64_t> cycles;
  void recall(const CycleRecord& record) { cycles.push_back(record.cycle); }
};

NotedLoop restored(const MadeUpLog& log) {
  NotedLoop loop;
  recall_cycles(log, kNowUtcS, loop);
  return loop;
}

TEST(RecallCycles, AreTheLastEightHoursOldestFirst) {
  const NotedLoop loop = restored(MadeUpLog(1'000));
  ASSERT_EQ(loop.cycles.size(), 240U);
  EXPECT_EQ(loop.cycles.front(), 761);
  EXPECT_EQ(loop.cycles.back(), 1'000);
  for (std::size_t i = 1; i < loop.cycles.size(); ++i) {
    EXPECT_EQ(loop.cycles[i], loop.cycles[i - 1] + 1);
  }
}

TEST(RecallCycles, AShortLogOrNoneIsRestoredCompletely) {
  EXPECT_TRUE(restored(MadeUpLog(0)).cycles.empty());
  EXPECT_EQ(restored(MadeUpLog(3)).cycles, (std::vector<std::int64_t>{1, 2, 3}));
}

TEST(RecallCycles, WhatIsOlderThanEightHoursIsForgotten) {
  MadeUpLog log(5);
  for (std::size_t i = 0; i < 3; ++i) log.records[i].utc_s -= 8 * 3'600;
  EXPECT_EQ(restored(log).cycles, (std::vector<std::int64_t>{4, 5}));
}

TEST(RecallCycles, ATripEndsThemAndIsNotRestoredItself) {
  MadeUpLog log(9);
  log.records[5].is_tripped = true;
  EXPECT_EQ(restored(log).cycles, (std::vector<std::int64_t>{7, 8, 9}));
  log.records.back().is_tripped = true;
  EXPECT_TRUE(restored(log).cycles.empty());
}

TEST(RecallCycles, ARecordThatCannotBeReadIsLeftOut) {
  MadeUpLog log(6);
  log.unreadable = {0, 2};
  EXPECT_EQ(restored(log).cycles, (std::vector<std::int64_t>{1, 2, 3, 5}));
}

TEST(RecallCycles, RecordsOfAClockThatWasAheadAreRestored) {
  MadeUpLog log(4);
  for (CycleRecord& record : log.records) record.utc_s += 3'600;
  EXPECT_EQ(restored(log).cycles.size(), 4U);
  EXPECT_LE(log.reads, 2 * 240 + 1);
}

TEST(TakeOver, AnOrderIsAsOldAsItsPower) {
  CycleRecord record;
  record.utc_s = kNowUtcS;
  record.ordered_power_w = 4'000;
  record.followed = {.is_judged = true, .power_w = 4'000, .age_s = 1'317};
  EXPECT_EQ(ordered_since_utc_s(record), kNowUtcS - 1'317);
  record.ordered_power_w = -4'000;
  EXPECT_EQ(ordered_since_utc_s(record), kNowUtcS);
  record.ordered_power_w = 4'000;
  record.followed.is_judged = false;
  EXPECT_EQ(ordered_since_utc_s(record), kNowUtcS);
}

TEST(TakeOver, TheLevelIsTheOneThatIsGivenAndTheRestTheRecords) {
  CycleRecord record;
  record.utc_s = kNowUtcS;
  record.ordered_power_w = -1'500;
  record.lost_orders.judged = 7;
  record.standing_price.unchanged_s = 840;
  const CycleRecord taken = take_over_of(record, PriceLevel{});
  EXPECT_EQ(taken.ordered_power_w, -1'500);
  EXPECT_EQ(taken.utc_s, kNowUtcS);
  EXPECT_EQ(taken.lost_orders.judged, 7);
  EXPECT_EQ(taken.standing_price.unchanged_s, 840);
}

constexpr std::int64_t kStartS = 1'700'000'000;

struct SteppedClock {
  std::int64_t now_ns = kStartS * kNanosecondsPerSecond;
  std::int64_t stepped_ns = 0;
  [[nodiscard]] std::int64_t now_utc_ns() const { return now_ns + stepped_ns; }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return utc_ns - stepped_ns;
  }
};

struct ObedientBattery {
  static Status order(const PowerOrder&) { return Status::kOk; }
};

TEST(SteadyTime, KnowsNothingOfSteps) {
  SteppedClock clock;
  SteadyTime time(clock);
  EXPECT_EQ(time.now_s(), kStartS);
  for (const std::int64_t step_s : {1, -2, 3'600, -86'400}) {
    clock.stepped_ns = step_s * kNanosecondsPerSecond;
    EXPECT_EQ(time.now_s(), kStartS) << step_s;
  }
  clock.now_ns += 7 * kNanosecondsPerSecond;
  EXPECT_EQ(time.now_s(), kStartS + 7);
  time.set_ahead(-30);
  EXPECT_EQ(time.now_s(), kStartS - 23);
}

TEST(OrderInForce, IsAsOldAsItIsWhateverTheClockSays) {
  SteppedClock clock;
  ObedientBattery battery;
  ControlSettings settings;
  settings.control = settings.has_watchdog = true;
  OrderInForce<ObedientBattery, SteppedClock> order(settings, battery, clock);
  const BatteryMeasurement m{.dispatch_active = true};
  ASSERT_EQ(order.write(2'000, 0, INT64_MAX), Status::kOk);
  for (const std::int64_t step_s : {0, -3'600, 3'600}) {
    clock.stepped_ns = step_s * kNanosecondsPerSecond;
    clock.now_ns += 50 * kNanosecondsPerSecond;
    const Response now = order.response(m);
    EXPECT_EQ(now.order_age_s, now.steady_s - kStartS) << step_s;
    EXPECT_GE(now.order_age_s, 50) << step_s;
    EXPECT_EQ(now.utc_s, now.steady_s + step_s);
  }
}

}  // namespace
}  // namespace bess
