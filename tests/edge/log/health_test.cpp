// From the published status to ok, degraded or not running: a table.
#include "edge/log/health.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/support/tokens.h"

namespace bess {
namespace {

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
TEST(Health, OkUpToTheBounds) {
  HealthInputs in = healthy_inputs();
  in.unanswered_orders = 5;
  in.wrong_energy_e6 = 49'999;
  const Health health = assess_health(in);
  EXPECT_EQ(health.level, HealthLevel::kOk);
  EXPECT_TRUE(health.reasons.empty());
}

/// Each by itself is one reason, which names its numbers, and no two are the same.
TEST(Health, EveryTroubleHasItsReason) {
  struct Case {
    void (*spoil)(HealthInputs&);
    const char* codes;
  };
  const Case cases[] = {
      {[](HealthInputs& in) { in.is_running = false; }, "CRITICAL bess-edge"},
      {[](HealthInputs& in) { in.is_of_this_run = false; }, "WARN"},
      {[](HealthInputs& in) { in.age_ms = 240'001; }, "WARN 240 120"},
      {[](HealthInputs& in) { in.age_ms = 480'001; }, "CRITICAL 480 120"},
      {[](HealthInputs& in) { in.update_trouble = "1.0; 2.0 it hangs"; }, "WARN 1.0; 2.0 it hangs"},
      {[](HealthInputs& in) { in.disk_used_life_percent = 100; }, "WARN 100 %"},
      {[](HealthInputs& in) { in.disk_spare_level = 2; }, "WARN 80 %"},
      {[](HealthInputs& in) { in.disk_spare_level = 3; }, "CRITICAL 90 %"},
      {[](HealthInputs& in) { in.file_system_errors = 3; }, "WARN 3"},
      {[](HealthInputs& in) { in.energy_share_percent = 54; }, "WARN 54 % capacity_wh"},
      {[](HealthInputs& in) { in.rest_loss_w = 390; }, "WARN 390 W"},
      {[](HealthInputs& in) { in.rest_loss_w = -800; }, "WARN 800 W"},
      {[](HealthInputs& in) { in.ramp_w_per_s = 30; }, "WARN 30 W/s bess-edge commission"},
      {[](HealthInputs& in) { in.wrong_energy_e6 = 66'000; }, "WARN 6 %"},
      {[](HealthInputs& in) { in.locked_readings = 31; }, "WARN 31"},
      {[](HealthInputs& in) { in.meter_status = "timeout"; }, "WARN meter timeout"},
      {[](HealthInputs& in) { in.meter_is_mismatch = true; }, "WARN meter"},
      {[](HealthInputs& in) { in.house_is_implausible = true, in.house_w = -631; },
       "WARN meter -631 [meter] pv_w_max"},
      {[](HealthInputs& in) { in.limit_status = "timeout"; }, "WARN 0 W"},
      {[](HealthInputs& in) { in.limit_status = "malformed"; }, "WARN [limits]"},
      {[](HealthInputs& in) { in.mode = "safe"; }, "WARN safe student"},
      {[](HealthInputs& in) { in.battery_status = "timeout"; }, "WARN battery timeout"},
      {[](HealthInputs& in) { in.price_status = "no_row"; }, "WARN prices no_row"},
      {[](HealthInputs& in) { in.unanswered_orders = 6; }, "WARN 6"},
      {[](HealthInputs& in) { in.weak_answers = 2; }, "WARN 2 power_w"},
      {[](HealthInputs& in) { in.battery_warns = true; }, "WARN"},
      {[](HealthInputs& in) {
         in.orders_are_lost = true, in.lost_orders = 10, in.judged_orders = 30;
       },
       "WARN 10 30"},
      {[](HealthInputs& in) { in.disk_is_slow = true; }, "WARN"},
      {[](HealthInputs& in) { in.disk_is_failing = true; }, "WARN"},
      {[](HealthInputs& in) { in.disk_is_full = true; }, "WARN"},
      {[](HealthInputs& in) { in.price_step_held = true, in.held_eur_per_mwh = 9'000; },
       "WARN 9000.00"},
      {[](HealthInputs& in) {
         in.has_price = in.price_frozen = true, in.price_eur_per_mwh = 55.5,
         in.price_unchanged_s = 1'800;
       },
       "WARN frozen_price 55.50 30"},
      {[](HealthInputs& in) { in.has_price = true, in.price_eur_per_mwh = -25'907.54; },
       "WARN -25907.54 15000"},
      {[](HealthInputs& in) { in.is_of_this_run = false, in.unknown = "process 12"; },
       "CRITICAL process 12"},
      {[](HealthInputs& in) { in.run_folder_is_failing = true; }, "WARN [state] run_folder"},
      {[](HealthInputs& in) { in.hold_is_unreadable = true; }, "WARN bess-edge hold"},
      {[](HealthInputs& in) { in.cycles_behind = 10; }, "WARN status.json 10"},
  };
  std::set<std::string> told;
  for (const Case& c : cases) {
    HealthInputs in = healthy_inputs();
    c.spoil(in);
    const Health health = assess_health(in);
    EXPECT_EQ(health.level, in.is_running ? HealthLevel::kDegraded : HealthLevel::kNotRunning);
    ASSERT_EQ(health.reasons.size(), 1U) << c.codes;
    EXPECT_THAT(health.reasons[0], Names(c.codes));
    EXPECT_TRUE(told.insert(health.reasons[0]).second) << health.reasons[0];
  }
}

/// A controller that hangs on a full disk must not look as if only the disk were full.
TEST(Health, TheAgeIsToldBesideTheDisk) {
  HealthInputs in = healthy_inputs();
  in.cycles_behind = 10;
  in.age_ms = 481'000;
  const Health health = assess_health(in);
  ASSERT_EQ(health.reasons.size(), 2U);
  EXPECT_THAT(health.reasons[0], Names("CRITICAL 481"));
  EXPECT_THAT(health.reasons[1], Names("WARN 10"));
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
