// Health by the published status (ok, degraded, not running): a table.
#include "edge/records/log/health.h"

#include <gmock/gmock.h>

#include <set>
#include <string>

#include "edge/records/log/alerts.h"
#include "shared/local_time.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

/// Status of a healthy run.
struct Well {
  Well() {
    status.totals.cycles = 1;
    last.mode = Mode::kRunning;
    last.reason = Reason::kStudent;
    last.battery_status = last.price.status = Status::kOk;
  }
  [[nodiscard]] Health health() const { return assess_health(in); }

  RunStatus status;
  CycleRecord& last = status.totals.last;
  HealthInputs in{.is_running = true, .status = &status, .is_of_this_run = true, .age_ms = 119'000};
};

/// README: more than five readings in a row.
TEST(Health, OkUpToTheBounds) {
  Well well;
  well.last.unanswered_orders = 5;
  well.last.findings.wrong_energy_e6 = 49'999;
  const Health health = well.health();
  EXPECT_EQ(health.level, HealthLevel::kOk);
  EXPECT_TRUE(health.alerts.empty());
}

/// Each fault gives one reason, which names its numbers, and no two reasons are equal.
TEST(Health, EveryTroubleHasItsReason) {
  struct Case {
    void (*spoil)(Well&);
    const char* codes;
  };
  const Case cases[] = {
      {[](Well& w) { w.in.is_running = false; }, "CRITICAL no_controller bess-edge"},
      {[](Well& w) { w.in.is_of_this_run = false; }, "WARN starting"},
      {[](Well& w) { w.in.age_ms = 240'001; }, "WARN overdue 240 120"},
      {[](Well& w) { w.in.age_ms = 480'001; }, "CRITICAL overdue 480 120"},
      {[](Well& w) { w.in.update_trouble = "1.0; 2.0 it hangs"; }, "WARN update 1.0; 2.0 it hangs"},
      {[](Well& w) { w.in.wear.used_life_percent = 100; }, "WARN storage_life 100 %"},
      {[](Well& w) { w.in.wear.spare_level = 2; }, "WARN storage_spare 80 %"},
      {[](Well& w) { w.in.wear.spare_level = 3; }, "CRITICAL storage_spare 90 %"},
      {[](Well& w) { w.in.wear.file_system_errors = 3; }, "WARN file_system 3"},
      {[](Well& w) { w.last.findings.energy_share_percent = 54; },
       "WARN energy_mismatch 54 % capacity_wh"},
      {[](Well& w) { w.last.findings.rest_loss_w = 390; }, "WARN unexplained_power 390 W"},
      {[](Well& w) { w.last.findings.rest_loss_w = -800; }, "WARN unexplained_power 800 W"},
      {[](Well& w) { w.last.findings.ramp_w_per_s = 30; },
       "WARN slow_response 30 W/s bess-edge commission"},
      {[](Well& w) { w.last.findings.wrong_energy_e6 = 66'000; }, "WARN set_point_ignored 6 %"},
      {[](Well& w) { w.last.findings.locked_readings = 31; }, "WARN own_limits 31"},
      {[](Well& w) { w.last.site.meter_status = Status::kTimeout; }, "WARN meter timeout"},
      {[](Well& w) { w.last.site.trust.is_mismatch = true; }, "WARN meter_mismatch"},
      {[](Well& w) { w.last.site.house_is_implausible = true, w.last.site.grid_power_w = -631; },
       "WARN house_power -631 [meter] pv_w_max"},
      {[](Well& w) { w.last.site.limit_status = Status::kTimeout; }, "WARN limit_expired 0 W"},
      {[](Well& w) { w.last.site.limit_status = Status::kMalformed; }, "WARN limit_file [limits]"},
      {[](Well& w) { w.last.mode = Mode::kSafe; }, "WARN student safe"},
      {[](Well& w) { w.last.battery_status = Status::kTimeout; }, "WARN battery timeout"},
      {[](Well& w) { w.last.price.status = Status::kNoRow; }, "WARN prices no_row"},
      {[](Well& w) { w.last.unanswered_orders = 6; }, "WARN no_power 6"},
      {[](Well& w) { w.last.weak_answers = 2; }, "WARN low_power 2 power_w"},
      {[](Well& w) { w.last.measurement.warning = true; }, "WARN battery_warning"},
      {[](Well& w) { w.last.lost_orders = {.judged = 30, .lost = 10, .is_found = true}; },
       "WARN lost_orders 10 30"},
      {[](Well& w) { w.status.totals.disk_is_slow = true; }, "WARN disk_slow"},
      {[](Well& w) { w.status.totals.disk_is_failing = true; }, "WARN log_unwritable"},
      {[](Well& w) { w.in.disk_is_full = true; }, "WARN disk_full"},
      {[](Well& w) {
         w.last.price.step_held = true, w.last.price.held_centi_eur_per_mwh = 900'000;
       },
       "WARN price_step 9000.00"},
      {[](Well& w) {
         w.last.price.has_row = w.last.price_frozen = true;
         w.last.price.price_centi_eur_per_mwh = 5'550;
         w.last.standing_price.unchanged_s = 1'800;
       },
       "WARN frozen_price 55.50 30"},
      {[](Well& w) {
         w.last.price.has_row = true, w.last.price.price_centi_eur_per_mwh = -2'590'754;
       },
       "WARN unusual_price -25907.54 15000"},
      {[](Well& w) { w.in.is_of_this_run = false, w.in.unknown = "process 12"; },
       "CRITICAL unknown process 12"},
      {[](Well& w) { w.status.totals.run_folder_is_failing = true; },
       "WARN run_folder [state] run_folder"},
      {[](Well& w) { w.last.hold.unreadable = true; }, "WARN hold_file bess-edge hold"},
      {[](Well& w) { w.in.cycles_behind = 10; }, "WARN status_behind 10"},
  };
  std::set<std::string> reported;
  for (const Case& c : cases) {
    Well well;
    c.spoil(well);
    const Health health = well.health();
    EXPECT_EQ(health.level, well.in.is_running ? HealthLevel::kDegraded : HealthLevel::kNotRunning);
    ASSERT_EQ(health.alerts.size(), 1U) << c.codes;
    const HealthAlert& alert = health.alerts[0];
    EXPECT_THAT(alert.line, Names(c.codes));
    EXPECT_THAT(alert.line, Names(std::string(alert.code) + ":"));
    EXPECT_TRUE(reported.insert(alert.line).second) << alert.line;
  }
}

TEST(Health, TheManualHasTheTableOfAlerts) {
  const std::string text = text_of_file(BESS_SOURCE_DIR "/shared/manual/guides/troubleshooting.md");
  std::string table = "|code|meaning|remedy|\n|---|---|---|\n";
  for (const AlertInfo& alert : kAlerts) {
    table.append("|`").append(alert.code).append("`|").append(alert.meaning);
    table.append("|").append(alert.remedy).append("|\n");
  }
  EXPECT_NE(text.find("\n\n" + table + "\n"), text.npos)
      << "troubleshooting.md must have exactly this:\n"
      << table;
}

TEST(Health, AnOutageHasItsBeginning) {
  set_market_time_zone();
  RunTotals totals;
  CycleRecord record;
  record.utc_s = 1'700'000'000;  // 2023-11-14 23:13 in Brussels
  record.battery_status = Status::kTimeout;
  totals.count(record);
  record.utc_s += 120;
  totals.count(record);
  EXPECT_EQ(totals.battery_since_utc_s, 1'700'000'000);
  EXPECT_EQ(totals.reason_since_utc_s, 1'700'000'000);
  Well well;
  well.last.battery_status = Status::kTimeout;
  well.status.totals.battery_since_utc_s = totals.battery_since_utc_s;
  EXPECT_THAT(well.health().alerts.at(0).line, Names("battery timeout 2023-11-14 23:13"));
}

/// A controller that hangs on a full disk must not look as if only the disk were full.
TEST(Health, TheAgeIsReportedInAdditionToTheDisk) {
  Well well;
  well.in.cycles_behind = 10;
  well.in.age_ms = 481'000;
  const Health health = well.health();
  ASSERT_EQ(health.alerts.size(), 2U);
  EXPECT_THAT(health.alerts[0].line, Names("CRITICAL 481"));
  EXPECT_THAT(health.alerts[1].line, Names("WARN 10"));
}

TEST(Health, StaleStartsBeyondTwoCadencesWhateverTheTimeScale) {
  Well well;
  well.status.identity.cadence_ms = 133;
  well.in.age_ms = 266;
  EXPECT_EQ(well.health().level, HealthLevel::kOk);
  well.in.age_ms = 267;
  EXPECT_EQ(well.health().level, HealthLevel::kDegraded);
}

}  // namespace
}  // namespace bess
