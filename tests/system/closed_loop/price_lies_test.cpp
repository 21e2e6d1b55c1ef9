// Wrong price source before the real control loop: its effect on the battery is bounded.
#include <gtest/gtest.h>

#include <vector>

#include "edge/app/program/restored_run.h"
#include "tests/support/fake_plant.h"

namespace bess {
namespace {

using Loop = FakePlant::Loop;

constexpr std::int32_t kExtremeCenti = 1'000'000;

/// Alternating high and low prices, beyond every threshold: the most that a source can request.
struct Liar : FakePlant {
  Liar() {
    prices.price = [](std::int64_t minute_utc_s) {
      return minute_utc_s / kSecondsPerStep % 2 == 0 ? kExtremeCenti : -kExtremeCenti;
    };
  }
};

/// Changes of sign among the last orders of an hour, counted independently of the loop.
int most_reversals_in_an_hour(const std::vector<CycleRecord>& records) {
  std::vector<int> reversals;
  int direction = 0;
  for (const CycleRecord& record : records) {
    const int now = record.ordered_power_w > 0 ? 1 : record.ordered_power_w < 0 ? -1 : 0;
    reversals.push_back(now != 0 && now == -direction ? 1 : 0);
    if (now != 0) direction = now;
  }
  int most = 0;
  for (std::size_t end = 0; end < reversals.size(); ++end) {
    int sum = 0;
    for (std::size_t i = 0; i < kStepsPerHour && i <= end; ++i) sum += reversals[end - i];
    most = std::max(most, sum);
  }
  return most;
}

TEST(PriceLies, ARestartDoesNotStartTheHourAgain) {
  Liar liar;
  std::vector<CycleRecord> records;
  CycleRecord before;
  for (int run = 0; run < 20; ++run) {
    Loop loop({.control = true, .guard = {}, .reversals_per_hour_max = 6}, liar.battery,
              liar.prices, liar.clock);
    loop.take_over(before);
    for (int i = 0; i < 5; ++i) records.push_back(run_cycle(loop));
    before.reversals = records.back().reversals;
    before.utc_s = records.back().utc_s;
  }
  EXPECT_EQ(most_reversals_in_an_hour(records), 6);
}

/// The loop with a frozen source: the same price under new stamps.
struct Hung : FakePlant {
  Hung() { set_price(9'000); }
};

/// 20 runs of ten minutes: each restores the log of the previous one.
TEST(PriceLies, ARestartDoesNotResetAFrozenPrice) {
  Hung hung;
  CycleRecord record;
  for (int run = 0; run < 20; ++run) {
    Loop loop({.control = true, .guard = {}}, hung.battery, hung.prices, hung.clock);
    loop.take_over(take_over_of(record, record.price_level));
    for (int cycle = 0; cycle < 5; ++cycle) record = run_cycle(loop);
    EXPECT_EQ(record.reason == Reason::kFrozenPrice, run >= 18) << run;
    if (run % 2 == 0) loop.stop(record);  // else killed
  }
}

}  // namespace
}  // namespace bess
