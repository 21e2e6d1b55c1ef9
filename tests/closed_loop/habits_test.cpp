// On every shipped map, through its registers: faults that come and go, a battery that echoes its
// order, and what a healthy battery does that looks like a fault.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/supervised_site.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

constexpr std::int32_t kDearCentiEur = 160'000;
#ifdef BESS_SANITIZED
const int kDays = 1;
#else
const int kDays = few_or_all(2, 30);
#endif

class EveryMapHabits : public ::testing::TestWithParam<MapVariant> {
 protected:
  /// Cycles until it is stopped, with `fault` in force at every so manieth; `cycles_max` + 1:
  /// never.
  static int cycles_to_stop(SupervisedSite& site, int every, int cycles_max,
                            const std::function<void(SupervisedSite&, bool)>& fault) {
    for (int cycle = 0; cycle <= cycles_max; ++cycle) {
      fault(site, cycle % every == 0);
      if (is_stop_reason(site.cycle().reason)) return cycle + 1;
    }
    return cycles_max + 1;
  }
  static void drive(SupervisedSite& site, int cycles) {
    site.prices.price = [](std::int64_t) { return kDearCentiEur; };
    for (int i = 0; i < cycles; ++i) ASSERT_FALSE(is_stop_reason(site.cycle().reason));
  }
};

TEST_P(EveryMapHabits, WhatComesAndGoesIsFound) {
  for (const double gain : {-1.0, 2.0}) {
    // The sun may outdo an order to discharge.
    if (gain < 0 && load_shipped_map(GetParam()).response.charges_by_itself) continue;
    for (const int every : {2, 3}) {
      SupervisedSite site(GetParam());
      drive(site, 3);
      const int cycles = cycles_to_stop(
          site, every, 3 * every,
          [&](SupervisedSite& s, bool breaks) { set_habits(s, {.gain = breaks ? gain : 1}); });
      std::printf("%-16s %-12s %2.0f times the order at every %d cycles: %d\n", GetParam().map,
                  GetParam().variant, gain, every, cycles);
      EXPECT_LE(cycles, 3 * every) << gain << " at every " << every;
    }
  }
}

TEST_P(EveryMapHabits, AnEchoIsFoundByTheSoc) {
  for (const double gain : {-1.0, 0.0}) {
    SupervisedSite site(GetParam());
    drive(site, 3);
    const int cycles = cycles_to_stop(site, 1, 10, [&](SupervisedSite& s, bool) {
      set_habits(s, {.gain = gain});
      set_display(s, {.order_as_power = true});
    });
    std::printf("%-16s %-12s echo, %2.0f times the order flows: %d cycles\n", GetParam().map,
                GetParam().variant, gain, cycles);
    EXPECT_LE(cycles, 5) << gain;
  }
}

TEST_P(EveryMapHabits, AnEchoOfHalfIsTold) {
  SupervisedSite site(GetParam());
  drive(site, 3);
  int cycles = 0;
  CycleRecord record;
  while (record.findings.energy_share_percent == 0 && cycles++ < 20) {
    set_habits(site, {.gain = 0.5});
    set_display(site, {.order_as_power = true});
    record = site.cycle();
    ASSERT_FALSE(is_stop_reason(record.reason)) << reason_name(record.reason);
  }
  std::printf("%-16s %-12s half of the order flows: told after %d cycles, %d %%\n", GetParam().map,
              GetParam().variant, cycles, record.findings.energy_share_percent);
  EXPECT_LE(cycles, 20);
  EXPECT_NEAR(record.findings.energy_share_percent, 50, 15);
}

/// A habit of a healthy battery, as it is at an hour of the day.
struct Habit {
  const char* name;
  std::function<void(SupervisedSite&, int hour)> live;
};

const std::vector<Habit> kHabits = {
    {"recalibrates by 6 % in the morning and back at night",
     [](SupervisedSite& s, int hour) {
       set_display(s, {.soc_offset_frac = hour >= 6 && hour < 22 ? 0.06 : 0});
     }},
    {"charges itself below 10 %",
     [](SupervisedSite& s, int) { set_habits(s, {.hidden_drain_w = 60, .forced_charge_w = 500}); }},
    {"balances when it is full",
     [](SupervisedSite& s, int) { set_habits(s, {.balancing_w = 450}); }},
    {"ramps slowly", [](SupervisedSite& s, int) { set_habits(s, {.ramp_w_per_s = 30}); }},
};

TEST_P(EveryMapHabits, AHealthyHabitTripsNothing) {
  for (const Habit& habit : kHabits) {
    SupervisedSite site(GetParam());
    std::mt19937_64 random(3);
    std::normal_distribution<> noise(0, 9'000);
    site.prices.price = [&](std::int64_t minute_utc_s) {
      const double hours = static_cast<double>(minute_utc_s % 86'400) / 3'600;
      return static_cast<std::int32_t>(9'000 + 12'000 * std::sin(hours) + noise(random));
    };
    int lost = 0;
    for (int i = 0; i < kDays * kStepsPerDay; ++i) {
      const auto hour =
          static_cast<int>(site.clock.now_utc_ns() / kNanosecondsPerSecond / 3'600 % 24);
      habit.live(site, hour);
      const CycleRecord record = site.cycle();
      ASSERT_FALSE(record.is_tripped)
          << habit.name << ": " << reason_name(record.trip.reason) << " in cycle " << i;
      ASSERT_LT(record.findings.wrong_energy_e6, WrongEnergy::kToldE6)
          << habit.name << " in cycle " << i;
      lost += is_stop_reason(record.reason) ? 1 : 0;
    }
    std::printf("%-16s %-12s %s: %d of %d cycles lost\n", GetParam().map, GetParam().variant,
                habit.name, lost, kDays * kStepsPerDay);
    EXPECT_LT(lost, kDays * kStepsPerDay / 10) << habit.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapHabits, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
