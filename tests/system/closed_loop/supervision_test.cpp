// Real control loop and driver against the simulated battery of every shipped map that does not
// follow orders, in moved time: detection time and orders until then; and a battery that is only
// slow, noisy and throttled, for a month.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "shared/utc_text.h"
#include "tests/support/supervised_site.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

constexpr std::int32_t kRatedW = 4'000;
#ifdef BESS_SANITIZED
const int kMonthDays = 3;  // many times slower
#else
const int kMonthDays = few_or_all(6, 30);
#endif

/// A fault, and its expected name.
struct Fault {
  const char* name;
  std::function<void(SupervisedSite&)> begin;
  Reason reason;
  bool rests = false;  ///< 0 W is ordered when it fails
};

const std::vector<Fault> kFaults = {
    {"goes the other way", [](SupervisedSite& s) { set_habits(s, {.gain = -1}); },
     Reason::kWrongDirection},
    {"twice the order", [](SupervisedSite& s) { set_habits(s, {.gain = 2}); },
     Reason::kUncontrolledPower},
    {"discharges at 0 W", [](SupervisedSite& s) { set_habits(s, {.idle_power_w = -3'000}); },
     Reason::kUncontrolledPower, true},
    {"does nothing", [](SupervisedSite& s) { set_habits(s, {.gain = 0}); }, Reason::kNoAnswer},
    {"SoC stands still", [](SupervisedSite& s) { set_display(s, {.soc_stands_still = true}); },
     Reason::kSocMismatch},
    {"another capacity", [](SupervisedSite& s) { set_display(s, {.capacity_factor = 5}); },
     Reason::kCapacity},
    {"another master",
     [](SupervisedSite& s) {
       s.clock.every_half_minute = [&s] {
         s.device.image.refresh(s.clock.now_utc_ns());
         s.device.image.order_from_outside(-kRatedW);
       };
     },
     Reason::kOtherMaster},
};

bool shows_capacity(const RegisterMap& map) {
  const int point = find_point(map, "capacity");
  return std::find(map.required.begin(), map.required.end(), point) != map.required.end();
}

/// Orders of a device without read-back: another controller cannot be seen.
bool reads_back(const RegisterMap& map) {
  const auto& writes = map.sequence(Command::kCharge).writes;
  return std::any_of(writes.begin(), writes.end(),
                     [](const BlockWrite& write) { return write.read_back != ReadBack::kNone; });
}

class EveryMapSupervised : public ::testing::TestWithParam<MapVariant> {};

TEST_P(EveryMapSupervised, EveryFaultIsNoticedWithinTwoCyclesAndDrivenNoFurther) {
  for (const Fault& fault : kFaults) {
    ControlSettings settings;
    if (fault.rests) settings.guard.soc_max_e4 = 4'000;  // full: 0 W, at any price
    SupervisedSite site(GetParam(), settings);
    const RegisterMap& map = site.device.test.map;
    if (fault.reason == Reason::kCapacity && !shows_capacity(map)) continue;
    if (fault.reason == Reason::kOtherMaster && !reads_back(map)) continue;
    trade_both_ways(site);
    if (fault.rests) site.prices.price = [](std::int64_t) { return -60'000; };
    for (int i = 0; i < 8; ++i) {
      const CycleRecord record = site.cycle();
      ASSERT_FALSE(is_stop_reason(record.reason))
          << fault.name << " " << reason_name(record.reason);
    }
    // A map whose idle order is no order to the simulator cannot show a fault at rest.
    if (fault.rests && !site.device.battery.dispatch_active()) continue;
    fault.begin(site);
    int cycles = 0;
    CycleRecord record;
    do {
      record = site.cycle();
      ++cycles;
    } while (!is_stop_reason(record.reason) && cycles < 10);
    EXPECT_EQ(record.reason, fault.reason) << fault.name << ": " << reason_name(record.reason);
    // The reading that ends the second control cycle finds it, at the tick of the third. Excess
    // charge of a hybrid may come from the sun: only the discharging control cycles show it.
    const bool may_be_sun =
        map.response.charges_by_itself && fault.reason == Reason::kUncontrolledPower;
    // A SoC in whole percents that may be a minute old shows little where the order reverses every
    // four minutes.
    const bool is_coarse = map.response.soc_step_e4 >= 100 && fault.reason == Reason::kSocMismatch;
    EXPECT_LE(cycles, may_be_sun ? 5 : is_coarse ? 7 : 3) << fault.name;
    EXPECT_EQ(record.mode, Mode::kSafe) << fault.name;
    EXPECT_EQ(record.ordered_power_w, 0) << fault.name;
    // From here on no order of ours is in force.
    site.clock.every_half_minute = [] {};
    for (int i = 0; i < 4; ++i) {
      record = site.cycle();
      EXPECT_EQ(record.ordered_power_w, 0) << fault.name;
      EXPECT_FALSE(record.measurement.dispatch_active) << fault.name;
    }
  }
}

/// The identity check every ten minutes also reads the capacity, and ends the reading: whichever is
/// first, the reported cause stays while it lasts. Then the battery is driven again.
TEST_P(EveryMapSupervised, AnotherCapacityStaysTheReportedReason) {
  for (int phase = 0; phase < 5; ++phase) {
    SupervisedSite site(GetParam());
    RegisterMap& map = site.device.test.map;
    if (!shows_capacity(map)) continue;
    for (IdentityCheck& check : map.identity) {  // as limited by the configuration
      if (map.points[check.point].name != "capacity") continue;
      check.value_min = 6'000;
      check.value_max = 10'000;
    }
    site.prices.price = [](std::int64_t) { return -60'000; };
    for (int i = 0; i < 6 + phase; ++i) ASSERT_FALSE(is_stop_reason(site.cycle().reason));
    set_display(site, {.capacity_factor = 5});
    site.cycle();
    for (int i = 0; i < 20; ++i) {
      const CycleRecord record = site.cycle();
      EXPECT_EQ(reason_name(record.reason), "capacity") << "phase " << phase << ", cycle " << i;
      EXPECT_EQ(record.mode, Mode::kSafe);
      EXPECT_FALSE(record.measurement.dispatch_active);
    }
    set_display(site, {});
    for (int i = 0; i < 6; ++i) site.cycle();
    EXPECT_EQ(site.cycle().mode, Mode::kRunning);
  }
}

TEST_P(EveryMapSupervised, LessThanOrderedIsReportedWithinTwoCycles) {
  SupervisedSite site(GetParam());
  trade_both_ways(site);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(site.cycle().weak_answers, 0);
  set_habits(site, {.gain = 0.3});
  for (int i = 0; i < 2; ++i) site.cycle();
  const CycleRecord record = site.cycle();
  EXPECT_GE(record.weak_answers, 2);
  EXPECT_FALSE(is_stop_reason(record.reason)) << reason_name(record.reason);
}

/// Days of varying prices, with a battery that is slow, noisy and throttled.
template <typename After>
void expect_nothing_raised(SupervisedSite& site, int days, const After& after_cycle) {
  set_habits(site, {.delay_s = 5, .noise_frac = 0.02, .slows_near_limits = true});
  std::mt19937_64 random(3);
  std::normal_distribution<> noise(0, 9'000);
  site.prices.price = [&](std::int64_t minute_utc_s) {
    const double hours = static_cast<double>(minute_utc_s % 86'400) / 3'600;
    return static_cast<std::int32_t>(9'000 + 12'000 * std::sin(hours) + noise(random));
  };
  for (int i = 0; i < days * kStepsPerDay; ++i) {
    const CycleRecord record = site.cycle();
    ASSERT_FALSE(is_stop_reason(record.reason))
        << "cycle " << i << " " << reason_name(record.reason);
    ASSERT_LT(record.weak_answers, 2) << "cycle " << i;
    ASSERT_EQ(record.replaced_orders + record.ended_orders, 0) << "cycle " << i;
    ASSERT_LT(record.findings.wrong_energy_e6, WrongEnergy::kReportedE6) << "cycle " << i;
    after_cycle(i, record);
  }
}

TEST_P(EveryMapSupervised, DaysOfASlowNoisyThrottledBatteryRaisesNothing) {
  SupervisedSite site(GetParam());
  int driven = 0;
  expect_nothing_raised(site, kMonthDays, [&](int, const CycleRecord& record) {
    driven += record.ordered_power_w != 0 ? 1 : 0;
  });
  EXPECT_GT(driven, kMonthDays * kStepsPerDay / 4);
}

/// Holds, a reserve, a full charge every other day, and a meter that cuts orders between control
/// cycles.
TEST_P(EveryMapSupervised, DaysOfHoldsReserveAndCutOrdersRaiseNothing) {
  const int kDays = kMonthDays / 3;
  set_market_time_zone();
  ControlSettings settings;
  settings.reserve.push_back({.from_minute = 16 * 60, .to_minute = 22 * 60, .soc_e4 = 6'000});
  settings.full_charge_every_days = 1;
  SiteSettings meter;
  meter.meter = MeterSource::kMap;
  meter.connection = {.import_w_max = 4'500, .export_w_max = 2'000, .peak_w_max = 3'500};
  SupervisedSite site(GetParam(), settings, meter);
  LatestHold holds;
  site.loop->follow_holds(holds);
  std::mt19937_64 random(4);
  int held = 0, reserved = 0, filled = 0, cuts = 0;
  expect_nothing_raised(site, kDays, [&](int i, const CycleRecord& record) {
    held += record.reason == Reason::kHeld;
    reserved += record.reason == Reason::kReserve;
    filled += record.reason == Reason::kFullCharge;
    cuts = record.site.order_cuts;
    if (i % 150 != 0) return;
    const std::int64_t end_utc_s = site.clock.now_utc_ns() / kNanosecondsPerSecond + 3'600;
    holds.publish({.power_w = static_cast<std::int32_t>(random() % 8'000) - 4'000,
                   .until_utc_s = static_cast<std::uint32_t>(end_utc_s)});
  });
  EXPECT_GT(held, kDays * 20);
  EXPECT_GT(reserved, kDays);
  EXPECT_GT(filled, 0);
  EXPECT_GT(cuts, kDays * 10);
}

/// Paused between two control cycles, continued twenty minutes later: the watchdog has ended the
/// order, and it stays ended until a new price is decided on.
TEST_P(EveryMapSupervised, AProcessThatWasPausedDoesNotContinueItsOldOrder) {
  constexpr std::int64_t kStoppedS = 1'230;
  SupervisedSite site(GetParam());
  if (site.device.test.map.watchdog.kind == Watchdog::Kind::kNone) {
    GTEST_SKIP() << "without a watchdog an order stays in force";
  }
  site.prices.price = [](std::int64_t) { return -60'000; };
  CycleRecord before;
  for (int i = 0; i < 3; ++i) before = site.cycle();
  ASSERT_EQ(before.ordered_power_w, kRatedW);
  bool was_stopped = false;
  site.clock.every_half_minute = [&] {
    if (std::exchange(was_stopped, true)) return;
    site.device.test.device.now_ns += kStoppedS * kNanosecondsPerSecond;
    auto& after_write = site.device.test.device.after_write;
    after_write = [&site, act = after_write](int address, int count) {
      act(address, count);
      // An order of several writes passes through mixtures of the old and the new.
      if (site.device.test.map.sequence(Command::kIdle).writes.size() > 1) return;
      EXPECT_EQ(site.device.battery.commanded_power_w(), 0);
    };
  };
  const CycleRecord record = site.cycle();
  EXPECT_EQ(record.ordered_power_w, 0);  // the reading is as old as the tick
  const std::int64_t ended_utc_s =
      before.utc_s + kSecondsPerStep + site.device.test.map.watchdog.duration_s;
  site.device.battery.advance(site.clock.now_utc_ns());
  int minutes = 0;
  for (const MinuteRecord& minute : site.device.battery.record()) {
    if (minute.minute_utc_s < ended_utc_s) continue;
    ++minutes;
    EXPECT_EQ(minute.commanded_power_w, 0) << utc_text(minute.minute_utc_s).view();
  }
  EXPECT_GT(minutes, 8);
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapSupervised, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
