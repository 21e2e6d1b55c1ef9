// The one table of what is logged of a cycle. Ring, journal, CSV, status.json and metrics are
// written from it, and the ring is read by it.
//
// A new field is a member of CycleRecord and an entry here, at the END: the order of the entries is
// their order on disk (record_codec.h). In a record of an older program it reads as 0. What the
// numbers mean: `Places` in field.h.
#pragma once

#include "edge/control/control_types.h"
#include "edge/log/field.h"

namespace bess {

consteval auto make_record_fields() {
  using R = CycleRecord;
  using B = BatteryMeasurement;
  using P = PriceReport;
  using C = BatteryCounters;
  using D = DayThroughput;
  using L = PriceLevel;
  using V = ReversalHistory;
  return std::to_array<Field<CycleRecord>>({
      {utc_member<&R::utc_s>(),
       "utc",
       {.journal = 1, .csv = 1, .last = 11, .metrics = {31, "bess_last_cycle_timestamp_seconds"}},
       {"Tick of the last cycle, UTC."}},
      {member<&R::cycle>(), "cycle", {.journal = 2, .csv = 2, .last = 12}},
      {member<&R::mode>(), "mode", {.journal = 3, .csv = 3, .last = 13}},
      {member<&R::has_measurement>(), "has_measurement", {.last = 21}},
      {member<&R::measurement, &B::soc_e4>().given<&R::has_measurement>(),
       "soc_e4",
       {.journal = 6, .csv = 7, .last = 22, .metrics = {11, "bess_soc_ratio"}},
       {"State of charge of the battery, 0 to 1.", 10'000}},
      {member<&R::measurement, &B::power_w>().given<&R::has_measurement>(),
       "battery_power_w",
       {.journal = 7, .csv = 8, .last = 23, .metrics = {12, "bess_power_watts"}},
       {"Power of the battery, positive when it charges."}},
      {member<&R::measurement, &B::capacity_wh>()},
      {member<&R::measurement, &B::charge_w_max>()},
      {member<&R::measurement, &B::discharge_w_max>()},
      {member<&R::measurement, &B::temperature_min_deci_c>()},
      {member<&R::measurement, &B::temperature_max_deci_c>()},
      {member<&R::measurement, &B::alarm>(), "alarm", {.last = 31}},
      {member<&R::measurement, &B::off_grid>(), "off_grid", {.last = 32}},
      {member<&R::measurement, &B::dispatch_active>(), "dispatch_active", {.last = 33}},
      {member<&R::measurement, &B::has_order_power>()},
      {member<&R::measurement, &B::order_power_w>()},
      {member<&R::price, &P::has_row>(), "has_price", {.last = 41}},
      {utc_member<&R::price, &P::minute_utc_s>().given<&R::price, &P::has_row>(),
       "price_minute_utc",
       {.csv = 4, .last = 42}},
      {member<&R::price, &P::price_centi_eur_per_mwh>().given<&R::price, &P::has_row>(),
       "price_centi_eur_per_mwh",
       {.journal = {4, "price_centi"},
        .csv = 5,
        .last = 43,
        .metrics = {14, "bess_price_eur_per_mwh"}},
       {"Imbalance price the decision was made with.", 100}},
      {member<&R::price, &P::received_monotonic_ns>()},
      {member<&R::price, &P::fetch_us>(), "fetch_us", {.journal = 14, .csv = 15, .last = 81}},
      {member<&R::price, &P::status>(),
       "price_status",
       {.journal = {12, "prices"}, .csv = 13, .last = 53}},
      {member<&R::price, &P::large_step>(), "large_step", {.csv = 20, .last = 52}},
      {member<&R::price_age_s>().given<&R::price, &P::has_row>(),
       "price_age_s",
       {.journal = 5, .csv = 6, .last = 51, .metrics = {15, "bess_price_age_seconds"}},
       {"Age of that price at the decision."}},
      {member<&R::has_student_action>()},
      {member<&R::student_action>().given<&R::has_student_action>(),
       "student_action",
       {.journal = {8, "student"}, .csv = 9, .last = 61}},
      {member<&R::ordered_power_w>(),
       "ordered_power_w",
       {.journal = 9, .csv = 10, .last = 62, .metrics = {13, "bess_setpoint_watts"}},
       {"Power ordered, positive is charging."}},
      {member<&R::reason>(), "reason", {.journal = 10, .csv = 11, .last = 63}},
      {member<&R::battery_status>(),
       "battery_status",
       {.journal = {11, "battery"}, .csv = 12, .last = 71}},
      {member<&R::written>(), "written", {.journal = 13, .csv = 14, .last = 72}},
      {member<&R::decision_us>(), "decision_us", {.journal = 15, .csv = 16, .last = 82}},
      {member<&R::write_us>(), "write_us", {.journal = 16, .csv = 17, .last = 83}},
      {member<&R::total_us>(), "total_us", {.journal = 17, .csv = 18, .last = 84}},
      {member<&R::missed_ticks>(),
       "missed_ticks",
       {.journal = 18, .csv = 19, .totals = 12, .metrics = {33, "bess_missed_ticks_total"}},
       {"Ticks skipped because a cycle overran."}},
      {member<&R::counters, &C::requests>(), "requests", {.csv = 21, .totals = 61}},
      {member<&R::counters, &C::failed_requests>(), "failed_requests", {.csv = 22, .totals = 62}},
      {member<&R::counters, &C::reconnects>(),
       "reconnects",
       {.csv = 23, .totals = 63, .metrics = {21, "bess_modbus_reconnects_total"}},
       {"Connections opened to the battery."}},
      {member<&R::counters, &C::register_writes>(),
       "register_writes",
       {.csv = 24, .totals = 71, .metrics = {22, "bess_register_writes_total"}},
       {"Write requests that reached the battery."}},
      {member<&R::counters, &C::unchanged_orders>(), "unchanged_orders", {.csv = 25, .totals = 72}},
      {member<&R::counters, &C::flash_day>()},
      {member<&R::counters, &C::flash_writes_today>(),
       "flash_writes_today",
       {.csv = 26, .totals = 73}},
      {member<&R::deadline_misses>(),
       "deadline_misses",
       {.journal = 19, .csv = 27, .totals = 21, .metrics = {34, "bess_deadline_misses_total"}},
       {"Cycles whose order was not in force in time."}},
      {member<&R::unanswered_orders>(),
       "unanswered_orders",
       {.csv = 28, .totals = 22, .metrics = {35, "bess_unanswered_orders"}},
       {"Orders in a row that the battery did not answer with power."}},
      {member<&R::throughput, &D::local_day>()},
      {member<&R::throughput, &D::soc_moved_e4>(),
       "soc_moved_e4",
       {.csv = 29, .totals = {23, "soc_moved_e4_today"}, .metrics = {36, "bess_full_cycles_today"}},
       {"Full cycles that orders have moved on this local day.", 20'000}},
      {member<&R::price_level, &L::centi_q16>(),
       "price_level_centi_q16",
       {.csv = 30, .last = 44, .metrics = {16, "bess_price_level_eur_per_mwh"}},
       {"Trailing level of the prices, the student's context.", L::kQ16PerEur}},
      {member<&R::price_level, &L::row_minute_utc_s>()},
      {member<&R::context_class>().given<&R::has_student_action>(),
       "context_class",
       {.csv = 31, .last = 64}},
      {member<&R::price, &P::step_held>(),
       "step_held",
       {.journal = 20, .csv = 32, .last = 54, .metrics = {17, "bess_price_step_held"}},
       {"1 while a row far from the one before waits for the next."}},
      {member<&R::price, &P::held_centi_eur_per_mwh>().given<&R::price, &P::step_held>(),
       "held_centi_eur_per_mwh",
       {.journal = {21, "held_centi"}, .csv = 33, .last = 55}},
      {member<&R::reversals, &V::steps>()},
      {member<&R::reversals, &V::direction>()},
      {member<&R::reversals, &V::in_hour>(),
       "reversals_in_hour",
       {.csv = 34, .totals = 24, .metrics = {39, "bess_reversals_last_hour"}},
       {"Changes between charging and discharging in the last hour."}},
  });
}

inline constexpr auto kRecordFields = make_record_fields();

}  // namespace bess
