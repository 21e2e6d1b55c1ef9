// Real control loop against the battery model and a fake clock: whole days in milliseconds, with
// faults from a named seed, and invariants under any fault of bus, market and clock.
#include "edge/core/loop/control_loop.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/support/fake_plant.h"

namespace bess {
namespace {

using Plant = FakePlant;

ControlSettings in_control() { return {.control = true, .guard = {}}; }

TEST(ClosedLoop, ReadOnlyNeverWrites) {
  Plant plant(0.5, ControlSettings{});
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(plant.cycle().written);
  EXPECT_EQ(plant.stop().battery_status, Status::kOk);
  EXPECT_TRUE(plant.battery.orders.empty());
  EXPECT_EQ(plant.battery.releases, 0);
}

/// It has no orders that another controller could replace.
TEST(ClosedLoop, ReadOnlyLosesNoOrderToAnotherController) {
  Plant plant(0.5, ControlSettings{});
  plant.battery.physics.start_dispatch(1'000, 1.0, 3'600);
  for (int i = 0; i < 10; ++i) {
    const CycleRecord record = plant.cycle();
    EXPECT_TRUE(record.measurement.dispatch_active);
    EXPECT_FALSE(is_stop_reason(record.reason));
    EXPECT_EQ(record.replaced_orders, 0);
  }
}

TEST(ClosedLoop, NothingIsOrderedBeforeAllIsKnown) {
  Plant plant;
  plant.prices.outage = true;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(plant.cycle().mode, Mode::kStart);
  plant.clock.synchronised = false;
  plant.prices.outage = false;
  EXPECT_EQ(plant.cycle().reason, Reason::kClock);
  EXPECT_TRUE(plant.battery.orders.empty());
  plant.clock.synchronised = true;
  EXPECT_EQ(plant.cycle().mode, Mode::kRunning);
}

TEST(ClosedLoop, CountsTheTicksThatAnOverrunSkipped) {
  Plant plant;
  plant.cycle();
  plant.clock.now_ns += 500 * kNanosecondsPerSecond;
  EXPECT_EQ(plant.cycle().missed_ticks, 4);
}

TEST(ClosedLoop, ARestartTakesOverWhatTheBatteryIsDoing) {
  Plant plant;
  plant.set_price(kCheapCenti);
  plant.battery.physics.start_dispatch(4'000, 1.0, 300);  // the order of the previous run
  const CycleRecord record = plant.cycle();
  EXPECT_EQ(record.measurement.order_power_w, 4'000);
  EXPECT_EQ(record.mode, Mode::kRunning);
  EXPECT_EQ(plant.battery.orders.size(), 1U);
  EXPECT_EQ(plant.battery.orders[0].power_w, 4'000);  // no step in power in between
}

TEST(ClosedLoop, ARestartWithoutAPriceHoldsZeroAndReleasesTheOldOrder) {
  Plant plant;
  plant.prices.outage = true;
  plant.battery.physics.start_dispatch(-4'000, 0.1, 3'600);
  EXPECT_EQ(plant.cycle().mode, Mode::kHolding);
  EXPECT_EQ(plant.battery.orders.back().power_w, 0);
  for (int i = 0; i < 4; ++i) plant.cycle();
  EXPECT_EQ(plant.battery.releases, 1);
}

TEST(ClosedLoop, AStopAfterARestartReleasesTheOldOrderToo) {
  for (const int cycles : {0, 1}) {  // before the first as well
    Plant plant;
    plant.prices.outage = true;
    plant.battery.physics.start_dispatch(-4'000, 0.1, 3'600);
    for (int i = 0; i < cycles; ++i) plant.cycle();
    EXPECT_EQ(plant.stop().battery_status, Status::kOk);
    EXPECT_EQ(plant.battery.releases, 1);
    EXPECT_FALSE(plant.battery.physics.dispatch_active());
  }
}

TEST(ClosedLoop, NothingIsHandedOverToABatteryWithoutAWatchdog) {
  Plant plant;
  plant.cycle();
  CycleRecord record;
  EXPECT_FALSE(plant.loop.hand_over(record));
}

TEST(ClosedLoop, AStopWithoutADeadManTriesAgainUntilTheBatteryIsReleased) {
  Plant plant;
  plant.cycle();
  plant.battery.failing_releases = 3;
  EXPECT_EQ(plant.stop().battery_status, Status::kOk);
  EXPECT_FALSE(plant.battery.physics.dispatch_active());
  Plant unreachable;  // stops eventually
  unreachable.cycle();
  unreachable.battery.link = false;
  const std::int64_t start_ns = unreachable.clock.now_ns;
  EXPECT_EQ(unreachable.stop().battery_status, Status::kTimeout);
  EXPECT_LE(unreachable.clock.now_ns - start_ns, 90 * kNanosecondsPerSecond);
}

TEST(ClosedLoop, AStopWithADeadManTriesOnceAndSaysWhatFailed) {
  ControlSettings settings = in_control();
  settings.has_watchdog = true;
  for (const bool has_link : {true, false}) {
    Plant plant(0.5, settings);
    plant.cycle();
    plant.battery.link = has_link;
    plant.battery.failing_releases = 100;
    const std::int64_t start_ns = plant.clock.now_ns;
    EXPECT_EQ(plant.stop().battery_status, Status::kTimeout) << "also where its 0 W was taken";
    EXPECT_LT(plant.clock.now_ns - start_ns, 5 * kNanosecondsPerSecond);
  }
}

TEST(ClosedLoop, TheWatchdogIsRefreshedAsOftenAsTheMapAsks) {
  Plant plant;
  plant.battery.refresh_s = 30;
  plant.cycle();
  EXPECT_TRUE(plant.battery.refreshed_ns.empty());  // nothing was in force before the first order
  plant.cycle();
  ASSERT_GE(plant.battery.refreshed_ns.size(), 3U);
  const std::int64_t first_ns = plant.battery.refreshed_ns[0];
  EXPECT_EQ(plant.battery.refreshed_ns[1] - first_ns, 30 * kNanosecondsPerSecond);
  EXPECT_EQ(plant.battery.refreshed_ns[2] - first_ns, 60 * kNanosecondsPerSecond);
}

TEST(ClosedLoop, NothingIsRefreshedWithoutAnOrderOrInReadOnly) {
  Plant reader(0.5, ControlSettings{});
  Plant safe;
  reader.battery.refresh_s = safe.battery.refresh_s = 30;
  safe.prices.outage = true;
  for (int i = 0; i < 5; ++i) {
    reader.cycle();
    safe.cycle();
  }
  EXPECT_TRUE(reader.battery.refreshed_ns.empty());
  EXPECT_TRUE(safe.battery.refreshed_ns.empty());
}

TEST(ClosedLoop, ARestartKeepsTheCyclesOfTheDay) {
  set_market_time_zone();
  ControlSettings settings = in_control();
  settings.cycles_per_day_max_e4 = 5'000;
  Plant plant(0.5, settings);
  plant.loop.take_over({.throughput = {.local_day = 20'230'325, .soc_moved_e4 = 10'000}});
  plant.set_price(kCheapCenti);
  EXPECT_EQ(plant.cycle().reason, Reason::kCycleBudget);
}

/// Control cycles from one run to the next, killed after each, until one finds the effect of
/// `fault` on the battery.
int runs_until_trip(int cycles_per_run, const std::function<void(FakeBattery&, int)>& fault) {
  Plant plant;
  plant.set_price(kCheapCenti);
  std::vector<CycleRecord> log;
  for (int run = 1; run <= 20; ++run) {
    Plant::Loop loop(in_control(), plant.battery, plant.prices, plant.clock);
    for (const CycleRecord& record : log) loop.recall(record);
    if (!log.empty()) {
      const CycleRecord& newest = log.back();
      loop.take_over({.utc_s = newest.utc_s, .ordered_power_w = newest.ordered_power_w},
                     newest.is_tripped ? std::optional(newest.trip) : std::nullopt);
    }
    for (int i = 0; i < cycles_per_run; ++i) {
      fault(plant.battery, static_cast<int>(log.size()));
      log.push_back(run_cycle(loop));
      if (log.back().is_tripped) return static_cast<int>(log.size());
    }
  }
  return 99;
}

TEST(ClosedLoop, AKillAfterEachCycleHidesNoFault) {
  const auto inverted = [](FakeBattery& battery, int) { battery.inverted = true; };
  const auto every_other = [](FakeBattery& battery, int cycle) {
    battery.inverted = cycle % 2 == 1;
  };
  EXPECT_EQ(runs_until_trip(20, inverted), 3);
  EXPECT_EQ(runs_until_trip(1, inverted), 3);  // the order found is as old as the log says
  EXPECT_EQ(runs_until_trip(2, inverted), 3);
  EXPECT_LE(runs_until_trip(1, every_other), 6);
}

TEST(ClosedLoop, TheRestoredStateIsTheFoundOne) {
  Plant plant;
  plant.set_price(kCheapCenti);
  plant.battery.inverted = true;
  std::vector<CycleRecord> log;
  for (int i = 0; i < 2; ++i) log.push_back(plant.cycle());
  ASSERT_FALSE(log.back().is_tripped);  // one reading short of it
  Plant::Loop next(in_control(), plant.battery, plant.prices, plant.clock);
  Plant::Loop forgetful(in_control(), plant.battery, plant.prices, plant.clock);
  for (const CycleRecord& record : log) next.recall(record);
  EXPECT_FALSE(run_cycle(next).is_tripped);  // an order of unknown age proves nothing
  EXPECT_TRUE(run_cycle(next).is_tripped);
  EXPECT_FALSE(run_cycle(forgetful).is_tripped);
}

TEST(ClosedLoop, AFailedReadingKeepsItsCauseThoughTheOrderSucceeds) {
  Plant plant;
  plant.set_price(kCheapCenti);
  plant.cycle();
  plant.battery.is_implausible = true;
  const CycleRecord record = plant.cycle();
  EXPECT_EQ(record.reason, Reason::kLink);
  EXPECT_EQ(record.mode, Mode::kHolding);
  EXPECT_TRUE(record.written);  // 0 W
  EXPECT_EQ(record.battery_status, Status::kImplausible);
}

TEST(ClosedLoop, ThePriceIsLoggedAsOldAsAtTheWrite) {
  Plant plant;
  plant.set_price(kCheapCenti);
  plant.prices.arrives_after_ns = 7 * kNanosecondsPerSecond;
  EXPECT_EQ(plant.cycle().price_age_s, 7);
}

TEST(ClosedLoop, ATripOfThePreviousRunHoldsUntilItIsCleared) {
  Plant plant;
  plant.set_price(kCheapCenti);
  plant.loop.take_over({}, Trip{.reason = Reason::kUncontrolledPower, .utc_s = 7});
  for (int i = 0; i < 5; ++i) {
    const CycleRecord record = plant.cycle();
    EXPECT_EQ(record.reason, Reason::kUncontrolledPower);
    EXPECT_TRUE(record.is_tripped);
    EXPECT_EQ(record.trip.utc_s, 7);
  }
  EXPECT_TRUE(plant.battery.orders.empty());
  plant.loop.clear_trip();
  const CycleRecord record = plant.cycle();
  EXPECT_EQ(record.ordered_power_w, 4'000);
  EXPECT_FALSE(record.is_tripped);
}

TEST(ClosedLoop, WhatTheBatteryDoesWithoutAnOrderIsNoAnswerToOne) {
  Plant plant;
  plant.battery.refuses_orders = true;  // external control is switched off on the device
  plant.battery.offset_w = -2'000;      // it feeds the house in its own mode
  plant.set_price(kCheapCenti);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(plant.cycle().reason, Reason::kStudent);
  EXPECT_EQ(plant.cycle().reason, Reason::kOrdersFail);  // retried after a pause
  plant.battery.refuses_orders = false;
  plant.battery.offset_w = 0;
  CycleRecord record;
  for (int i = 0; i < 5; ++i) record = plant.cycle();
  EXPECT_EQ(record.reason, Reason::kStudent);
  EXPECT_TRUE(record.written);
}

TEST(ClosedLoop, ABatteryThatStillFollowsThePreviousOrderIsNotAgainstTheNewOne) {
  Plant plant;
  plant.battery.physics.start_dispatch(-4'000, 0.1, 3'600);
  plant.battery.refuses_orders = true;
  plant.set_price(kCheapCenti);
  for (int i = 0; i < 8; ++i) EXPECT_NE(plant.cycle().reason, Reason::kWrongDirection);
}

TEST(ClosedLoop, ABatteryThatDoesNothingIsCounted) {
  Plant plant(1.0);
  plant.battery.physics =
      SimulatedBattery({.power_w_max = 1, .capacity_wh = 8'000}, 0.5, plant.clock.now_ns);
  plant.set_price(kCheapCenti);
  plant.cycle();
  EXPECT_EQ(plant.cycle().unanswered_orders, 1);
  EXPECT_EQ(plant.cycle().reason, Reason::kNoAnswer);
}

TEST(ClosedLoop, AProcessThatWasSuspendedDoesNotActOnAnOldPriceOrReading) {
  Plant price, reading;
  price.prices.price = [&](std::int64_t) {
    price.clock.now_ns += 600 * kNanosecondsPerSecond;  // between the price and the decision
    return kCheapCenti;
  };
  reading.set_price(kCheapCenti);
  reading.prices.arrives_after_ns = 300 * kNanosecondsPerSecond;  // fresh, the reading is not
  for (Plant* plant : {&price, &reading}) {
    EXPECT_EQ(plant->cycle().reason, Reason::kLink);  // the reading is as old as the price
    EXPECT_TRUE(plant->battery.orders.empty());
  }
}

TEST(ClosedLoop, CountsOrdersThatComeTooLateOrNotAtAll) {
  Plant plant;
  EXPECT_EQ(plant.cycle().deadline_misses, 0);
  plant.battery.read_takes_ns = 70 * kNanosecondsPerSecond;
  EXPECT_EQ(plant.cycle().deadline_misses, 1);
  plant.battery.read_takes_ns = 0;
  EXPECT_EQ(plant.cycle().deadline_misses, 1);
  plant.battery.link = false;
  EXPECT_EQ(plant.cycle().deadline_misses, 2);
}

/// Toggles every fault at random; `chance` per cycle.
void disturb(Plant& plant, std::mt19937_64& random) {
  const auto toggle = [&](bool& fault, double on, double off) {
    const double u = std::uniform_real_distribution<>(0, 1)(random);
    fault = fault ? u >= off : u < on;
  };
  bool link_down = !plant.battery.link;
  bool unsynchronised = !plant.clock.synchronised;
  toggle(link_down, 0.02, 0.2);
  toggle(unsynchronised, 0.005, 0.3);
  toggle(plant.battery.alarm, 0.01, 0.3);
  toggle(plant.prices.outage, 0.03, 0.15);
  plant.battery.link = !link_down;
  plant.clock.synchronised = !unsynchronised;
}

void expect_invariants(const Plant& plant, const CycleRecord& record, double soc_start) {
  const double soc = plant.battery.physics.soc_frac();
  EXPECT_LE(soc, std::max(kHouse.soc_max_frac, soc_start) + 1e-12);
  EXPECT_GE(soc, std::min(kHouse.soc_min_frac, soc_start) - 1e-12);
  EXPECT_LE(std::abs(record.ordered_power_w), 4'000);
  if (is_stop_reason(record.reason)) {
    EXPECT_EQ(record.ordered_power_w, 0);
  }
  if (record.price_age_s > 240 + ControlSettings{}.price_wait_s) {  // 240 s at the tick
    EXPECT_EQ(record.ordered_power_w, 0);
  }
  if (record.mode == Mode::kSafe && record.written) {
    EXPECT_FALSE(plant.battery.physics.dispatch_active());
  }
}

TEST(ClosedLoop, InvariantsHoldThroughRandomFaults) {
  constexpr std::uint64_t kSeed = 20'240'122;
  std::mt19937_64 random(kSeed);
  for (int day = 0; day < 60; ++day) {
    const double soc_start = std::uniform_real_distribution<>(0.05, 1.0)(random);
    Plant plant(soc_start);
    plant.prices.price = [&](std::int64_t) {
      return std::uniform_int_distribution<std::int32_t>(-80'000, 180'000)(random);
    };
    int cycles_without_link = 0;
    for (int i = 0; i < kStepsPerDay; ++i) {
      disturb(plant, random);
      const CycleRecord record = plant.cycle();
      expect_invariants(plant, record, soc_start);
      cycles_without_link = plant.battery.link ? 0 : cycles_without_link + 1;
      // The watchdog: without a link nothing is exchanged after 300 s.
      if (cycles_without_link > 4) {
        EXPECT_FALSE(plant.battery.physics.dispatch_active());
      }
      if (HasFailure()) FAIL() << "seed " << kSeed << " day " << day << " cycle " << i;
    }
  }
}

}  // namespace
}  // namespace bess
