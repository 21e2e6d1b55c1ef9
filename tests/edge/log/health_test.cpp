// From the published status to ok, degraded or not running: a table.
#include "edge/log/health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bess {
namespace {

using ::testing::HasSubstr;

HealthInputs healthy_inputs() {
  HealthInputs in;
  in.is_running = in.is_of_this_run = true;
  in.age_ms = 119'000;
  in.cycles = 1;
  in.mode = "running";
  in.reason = "student";
  in.battery_status = in.price_status = "ok";
  return in;
}

/// README: more than five readings in a row.
TEST(Health, FiveUnansweredReadingsAreNotTooMany) {
  HealthInputs in = healthy_inputs();
  in.unanswered_orders = 5;
  EXPECT_EQ(assess_health(in).level, HealthLevel::kOk);
}

TEST(Health, OkWhenNothingIsAmiss) {
  const Health health = assess_health(healthy_inputs());
  EXPECT_EQ(health.level, HealthLevel::kOk);
  EXPECT_TRUE(health.reasons.empty());
}

TEST(Health, EveryTroubleHasItsReason) {
  struct Case {
    void (*spoil)(HealthInputs&);
    HealthLevel level;
    const char* reason;
  };
  const Case cases[] = {
      {[](HealthInputs& in) { in.is_running = false; }, HealthLevel::kNotRunning, "no bess-edge"},
      {[](HealthInputs& in) { in.is_of_this_run = false; }, HealthLevel::kDegraded, "no cycle has"},
      {[](HealthInputs& in) { in.cycles = 0; }, HealthLevel::kDegraded, "no cycle has"},
      {[](HealthInputs& in) { in.age_ms = 240'001; }, HealthLevel::kDegraded, "WARN: the last"},
      {[](HealthInputs& in) { in.update_trouble = "1.0; 2.0 was rolled back: it hangs"; },
       HealthLevel::kDegraded, "WARN: update: 1.0; 2.0 was rolled back: it hangs"},
      {[](HealthInputs& in) { in.disk_used_life_percent = 100; }, HealthLevel::kDegraded,
       "WARN: the card has used up to 100 % of its life: replace it"},
      {[](HealthInputs& in) { in.disk_spare_level = 2; }, HealthLevel::kDegraded,
       "WARN: the card has used 80 % of its spare blocks"},
      {[](HealthInputs& in) { in.disk_spare_level = 3; }, HealthLevel::kDegraded,
       "CRITICAL: the card has used 90 % of its spare blocks"},
      {[](HealthInputs& in) { in.file_system_errors = 3; }, HealthLevel::kDegraded,
       "WARN: the kernel has counted 3 errors in the state folder's file system"},
      {[](HealthInputs& in) { in.energy_share_percent = 54; }, HealthLevel::kDegraded,
       "WARN: the SoC shows about 54 % of the measured energy"},
      {[](HealthInputs& in) { in.rest_loss_w = 390; }, HealthLevel::kDegraded,
       "WARN: at 0 W, or besides its orders, the battery loses about 390 W"},
      {[](HealthInputs& in) { in.rest_loss_w = -800; }, HealthLevel::kDegraded,
       "WARN: at 0 W, or besides its orders, the battery gains about 800 W"},
      {[](HealthInputs& in) { in.ramp_w_per_s = 30; }, HealthLevel::kDegraded,
       "WARN: the battery is slower than its map says, at most 30 W/s from an order on"},
      {[](HealthInputs& in) { in.wrong_energy_e6 = 66'000; }, HealthLevel::kDegraded,
       "WARN: now and then the battery does not do as it is told: 6 % of its capacity flowed"},
      {[](HealthInputs& in) { in.locked_readings = 31; }, HealthLevel::kDegraded,
       "WARN: by its own limits the battery may neither charge nor discharge, in 31 readings"},
      {[](HealthInputs& in) { in.meter_status = "timeout"; }, HealthLevel::kDegraded,
       "WARN: meter: timeout"},
      {[](HealthInputs& in) { in.meter_is_mismatch = true; }, HealthLevel::kDegraded,
       "WARN: meter: it does not step with the battery"},
      {[](HealthInputs& in) {
         in.house_is_implausible = true;
         in.house_w = -631;
       },
       HealthLevel::kDegraded, "WARN: meter: house -631 W: a sign"},
      {[](HealthInputs& in) { in.limit_status = "timeout"; }, HealthLevel::kDegraded,
       "outside limit has lapsed"},
      {[](HealthInputs& in) { in.limit_status = "malformed"; }, HealthLevel::kDegraded,
       "cannot be read or understood"},
      {[](HealthInputs& in) { in.age_ms = 480'001; }, HealthLevel::kDegraded, "CRITICAL: the last"},
      {[](HealthInputs& in) { in.mode = "safe"; }, HealthLevel::kDegraded, "mode is safe"},
      {[](HealthInputs& in) { in.battery_status = "timeout"; }, HealthLevel::kDegraded, "timeout"},
      {[](HealthInputs& in) { in.price_status = "no_row"; }, HealthLevel::kDegraded, "no_row"},
      {[](HealthInputs& in) { in.energy_share_percent = 54; }, HealthLevel::kDegraded,
       "WARN: the SoC shows about 54 % of the measured energy"},
      {[](HealthInputs& in) { in.rest_loss_w = 390; }, HealthLevel::kDegraded,
       "WARN: at 0 W, or besides its orders, the battery loses about 390 W"},
      {[](HealthInputs& in) { in.rest_loss_w = -450; }, HealthLevel::kDegraded,
       "WARN: at 0 W, or besides its orders, the battery gains about 450 W"},
      {[](HealthInputs& in) { in.ramp_w_per_s = 30; }, HealthLevel::kDegraded,
       "WARN: the battery is slower than its map says, at most 30 W/s"},
      {[](HealthInputs& in) { in.unanswered_orders = 6; }, HealthLevel::kDegraded,
       "after 6 orders"},
      {[](HealthInputs& in) { in.battery_warns = true; }, HealthLevel::kDegraded,
       "WARN: the battery warns"},
      {[](HealthInputs& in) {
         in.orders_are_lost = true;
         in.lost_orders = 10;
         in.judged_orders = 30;
       },
       HealthLevel::kDegraded, "WARN: 10 of the last 30 orders were replaced or ended"},
      {[](HealthInputs& in) { in.disk_is_slow = true; }, HealthLevel::kDegraded, "too slow"},
      {[](HealthInputs& in) { in.disk_is_failing = true; }, HealthLevel::kDegraded, "disk full"},
      {[](HealthInputs& in) { in.disk_is_full = true; }, HealthLevel::kDegraded,
       "the disk of the state folder is full or read-only"},
      {[](HealthInputs& in) {
         in.price_step_held = true;
         in.held_eur_per_mwh = 9'000;
       },
       HealthLevel::kDegraded, "a row of 9000.00 EUR/MWh lies further"},
      {[](HealthInputs& in) {
         in.has_price = in.price_frozen = true;
         in.price_eur_per_mwh = 55.5;
         in.price_unchanged_s = 1'800;
       },
       HealthLevel::kDegraded, "frozen_price, 55.50 EUR/MWh has not moved for 30 minutes"},
      {[](HealthInputs& in) {
         in.has_price = true;
         in.price_eur_per_mwh = -25'907.54;
       },
       HealthLevel::kDegraded, "-25907.54 EUR/MWh lies beyond 15000: rare, and possible"},
      {[](HealthInputs&
              in) {  // what is known is of another run: it must not look as if this one were well
         in.is_of_this_run = false;
         in.unknown = "process 12 runs, but nothing tells of it";
       },
       HealthLevel::kDegraded, "CRITICAL: unknown: process 12 runs, but nothing tells of it"},
      {[](HealthInputs& in) { in.run_folder_is_failing = true; }, HealthLevel::kDegraded,
       "WARN: the files of [state] run_folder cannot be written"},
      {[](HealthInputs& in) { in.hold_is_unreadable = true; }, HealthLevel::kDegraded, "hold file"},
      {[](HealthInputs& in) { in.cycles_behind = 10; }, HealthLevel::kDegraded,
       "WARN: status.json is 10 cycles behind the log, is the disk full"},
  };
  for (const Case& c : cases) {
    HealthInputs in = healthy_inputs();
    c.spoil(in);
    const Health health = assess_health(in);
    EXPECT_EQ(health.level, c.level) << c.reason;
    ASSERT_EQ(health.reasons.size(), 1U) << c.reason;
    EXPECT_THAT(health.reasons[0], HasSubstr(c.reason));
  }
}

TEST(Health, LittleWrongEnergyIsNotWorthALine) {
  HealthInputs in = healthy_inputs();
  in.wrong_energy_e6 = 49'999;
  EXPECT_EQ(assess_health(in).level, HealthLevel::kOk);
}

/// A controller that hangs on a full disk must not look as if only the disk were full.
TEST(Health, TheAgeIsToldBesideTheDisk) {
  HealthInputs in = healthy_inputs();
  in.cycles_behind = 10;
  in.age_ms = 481'000;
  const Health health = assess_health(in);
  ASSERT_EQ(health.reasons.size(), 2U);
  EXPECT_THAT(health.reasons[0], HasSubstr("CRITICAL: the last cycle ended 481 s ago"));
  EXPECT_THAT(health.reasons[1], HasSubstr("10 cycles behind"));
}

TEST(Health, StaleStartsBeyondTwoCadencesWhateverTheTimeScale) {
  HealthInputs in = healthy_inputs();
  in.cadence_ms = 133;
  in.age_ms = 266;
  EXPECT_EQ(assess_health(in).level, HealthLevel::kOk);
  in.age_ms = 267;
  EXPECT_EQ(assess_health(in).level, HealthLevel::kDegraded);
}

}  // namespace
}  // namespace bess
