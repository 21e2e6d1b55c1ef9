// The one table of what is logged of a cycle. Ring, journal, CSV, status.json and metrics are
// written from it, and the ring is read by it.
//
// A new field is a member of CycleRecord and an entry here, at the END: the order of the entries is
// their order on disk (record_codec.h). In a record of an older program it reads as 0. What the
// numbers mean: `Places` in field.h.
#pragma once

#include <type_traits>

#include "edge/control/control_types.h"
#include "edge/log/field.h"
#include "edge/log/run_status.h"

namespace bess {

consteval auto make_record_fields() {
  using R = CycleRecord;
  using B = BatteryMeasurement;
  using P = PriceReport;
  using C = BatteryCounters;
  using D = DayThroughput;
  using L = PriceLevel;
  using V = ReversalHistory;
  using H = HoldReport;
  using S = SiteReport;
  using O = LostOrderHistory;
  using N = StandingPrice;
  using F = ResponseFindings;
  using W = FollowedOrder;
  using M = MeterTrust;
  using K = OutlookReport;
  using Q = PricedQuarterHour;
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
      {member<&R::measurement, &B::order_replaced>()},
      {member<&R::is_tripped>(),
       "is_tripped",
       {.last = 91, .metrics = {17, "bess_tripped"}},
       {"1 while the supervision keeps the battery released until a person clears it."}},
      {member<&R::trip, &Trip::reason>().given<&R::is_tripped>(), "trip", {.csv = 32, .last = 92}},
      {utc_member<&R::trip, &Trip::utc_s>().given<&R::is_tripped>(), "trip_utc", {.last = 93}},
      {member<&R::weak_answers>(),
       "weak_answers",
       {.csv = 33, .totals = 24, .metrics = {18, "bess_weak_answers"}},
       {"Readings in a row with less power than ordered and no reason for it."}},
      {member<&R::replaced_orders>(),
       "replaced_orders",
       {.csv = 34, .totals = 25, .metrics = {23, "bess_replaced_orders_total"}},
       {"Orders that somebody else replaced."}},
      {member<&R::price, &P::step_held>(),
       "step_held",
       {.journal = 20, .csv = 35, .last = 54, .metrics = {19, "bess_price_step_held"}},
       {"1 while a row far from the one before waits for the next."}},
      {member<&R::price, &P::held_centi_eur_per_mwh>().given<&R::price, &P::step_held>(),
       "held_centi_eur_per_mwh",
       {.journal = {21, "held_centi"}, .csv = 36, .last = 55}},
      {member<&R::reversals, &V::steps>()},
      {member<&R::reversals, &V::direction>()},
      {member<&R::reversals, &V::in_hour>(),
       "reversals_in_hour",
       {.csv = 37, .totals = 26, .metrics = {39, "bess_reversals_last_hour"}},
       {"Changes between charging and discharging in the last hour."}},
      {member<&R::hold, &H::held>(), "held", {.last = 141}},
      {member<&R::hold, &H::unreadable>(), "hold_unreadable", {.last = 142}},
      {member<&R::hold, &H::power_w>().given<&R::hold, &H::held>(),
       "hold_power_w",
       {.csv = 38, .last = 143, .metrics = {41, "bess_hold_watts"}},
       {"Power that an operator holds, positive is charging."}},
      {utc_member<&R::hold, &H::until_utc_s>().given<&R::hold, &H::held>(),
       "hold_until_utc",
       {.csv = 39, .last = 144, .metrics = {42, "bess_hold_until_timestamp_seconds"}},
       {"End of that hold, UTC."}},
      {member<&R::reserve_soc_e4>(),
       "reserve_soc_e4",
       {.csv = 40, .last = 151, .metrics = {43, "bess_reserve_soc_ratio"}},
       {"State of charge that is kept for a black-out at this hour, 0 to 1.", 10'000}},
      {member<&R::days_since_full>(),
       "days_since_full",
       {.csv = 41, .last = 152, .metrics = {44, "bess_days_since_full"}},
       {"Local days since the battery was last full."}},
      {member<&R::site, &S::has_grid_power>(), "has_grid_power", {.last = 161}},
      {member<&R::site, &S::grid_power_w>().given<&R::site, &S::has_grid_power>(),
       "grid_power_w",
       {.journal = {22, "grid_w"},
        .csv = 42,
        .last = 162,
        .metrics = {51, "bess_grid_power_watts"}},
       {"Power at the connection to the grid, positive is import."}},
      {member<&R::site, &S::quarter_hour_import_wh>().given<&R::site, &S::has_grid_power>(),
       "quarter_hour_import_wh",
       {.csv = 43, .last = 163, .metrics = {52, "bess_quarter_hour_import_watthours"}},
       {"Imported so far in this quarter-hour."}},
      {member<&R::site, &S::quarter_hour_battery_wh>().given<&R::site, &S::has_grid_power>(),
       "quarter_hour_battery_wh",
       {.csv = 44, .last = 164}},
      {member<&R::site, &S::order_cuts>(),
       "order_cuts",
       {.csv = 45, .totals = 27, .metrics = {53, "bess_order_cuts_total"}},
       {"Orders cut between two cycles by meter or outside limits."}},
      {member<&R::site, &S::meter_status>(),
       "meter_status",
       {.journal = {23, "meter"}, .csv = 46, .last = 171}},
      {member<&R::site, &S::limit_status>(), "limit_status", {.csv = 47, .last = 172}},
      {member<&R::measurement, &B::warning>(),
       "warning",
       {.last = 34, .metrics = {24, "bess_battery_warning"}},
       {"1 while the battery warns: see its own display."}},
      {member<&R::measurement, &B::order_ended>()},
      {member<&R::ended_orders>(),
       "ended_orders",
       {.csv = 48, .totals = 28, .metrics = {25, "bess_ended_orders_total"}},
       {"Orders that were gone before their end, with nothing written in their place."}},
      {member<&R::lost_orders, &O::orders>()},
      {member<&R::lost_orders, &O::judged>(),
       "judged_orders",
       {.csv = 49, .last = 182, .metrics = {27, "bess_judged_orders"}},
       {"How many orders bess_lost_orders looks back on, 30 at most."}},
      {member<&R::lost_orders, &O::lost>(),
       "lost_orders",
       {.csv = 50, .last = 181, .metrics = {26, "bess_lost_orders"}},
       {"Of the newest orders, those replaced or ended before their time."}},
      {member<&R::standing_price, &N::minute_utc_s>()},
      {member<&R::standing_price, &N::centi_eur_per_mwh>()},
      {member<&R::standing_price, &N::unchanged_s>().given<&R::price, &P::has_row>(),
       "price_unchanged_s",
       {.csv = 51, .last = 45, .metrics = {28, "bess_price_unchanged_seconds"}},
       {"Time that the price has not moved, under new stamps."}},
      {member<&R::price_frozen>(), "price_frozen", {.journal = 24, .csv = 52, .last = 56}},
      {member<&R::findings, &F::energy_share_percent>(),
       "energy_share_percent",
       {.csv = 53, .totals = 81, .metrics = {30, "bess_energy_share_ratio"}},
       {"Share of the measured energy that the state of charge shows; 0: nothing is wrong with it.",
        100}},
      {member<&R::findings, &F::rest_loss_w>(),
       "rest_loss_w",
       {.csv = 54, .totals = 82, .metrics = {29, "bess_rest_loss_watts"}},
       {"Power that is lost at 0 W or besides orders, where it is more than own consumption; else "
        "0."}},
      {member<&R::findings, &F::ramp_w_per_s>(),
       "ramp_w_per_s",
       {.csv = 55, .totals = 83, .metrics = {20, "bess_slow_ramp_watts_per_second"}},
       {"Rate at which the battery follows, where it is too slow for its register map; else 0."}},
      {member<&R::followed, &W::is_judged>()},
      {member<&R::followed, &W::power_w>()},
      {member<&R::followed, &W::age_s>()},
      {member<&R::followed, &W::soc_floor_e4>()},
      {member<&R::site, &S::trust, &M::is_mismatch>(),
       "meter_mismatch",
       {.csv = 56, .last = 173, .metrics = {54, "bess_meter_mismatch"}},
       {"1 while the meter at the connection does not step with the battery."}},
      {member<&R::site, &S::trust, &M::doubt>(),
       "meter_doubt",
       {.csv = 57, .last = 174, .metrics = {55, "bess_meter_doubt"}},
       {"Points against that meter; 10 are a mismatch."}},
      {utc_member<&R::site, &S::trust, &M::pause_until_utc_s>()
           .given<&R::site, &S::trust, &M::is_mismatch>(),
       "meter_pause_until_utc",
       {.last = 175}},
      {member<&R::site, &S::trust, &M::pause_s>()},
      {member<&R::site, &S::trust, &M::steps>()},
      {member<&R::site, &S::trust, &M::step_squares>()},
      {member<&R::site, &S::trust, &M::error_products>()},
      {member<&R::site, &S::trust, &M::error_squares>()},
      {member<&R::site, &S::house_is_implausible>(),
       "house_implausible",
       {.csv = 58, .last = 176, .metrics = {56, "bess_house_implausible"}},
       {"1 while grid less battery is no load that the house can have."}},
      {member<&R::lost_orders, &O::is_found>(),
       "orders_are_lost",
       {.csv = 59, .last = 183, .metrics = {10, "bess_orders_are_lost"}},
       {"1 while somebody or the device ends or replaces too many orders."}},
      {member<&R::findings, &F::locked_readings>(),
       "locked_readings",
       {.csv = 60, .totals = 84, .metrics = {40, "bess_locked_readings"}},
       {"Readings in a row in which the battery's own limits allow nothing."}},
      {member<&R::outlook, &K::source>().given<&R::outlook, &K::source>(),
       "outlook",
       {.csv = 61, .last = 191}},
      {member<&R::outlook, &K::break_even_centi>().given<&R::outlook, &K::source>(),
       "break_even_centi",
       {.csv = 62, .last = 192, .metrics = {60, "bess_break_even_eur_per_mwh"}},
       {"Price at which the plan on day-ahead prices would as soon charge as discharge.", 100}},
      {member<&R::outlook, &K::known_quarter_hours>().given<&R::outlook, &K::source>(),
       "outlook_quarter_hours",
       {.csv = 63, .last = 193, .metrics = {61, "bess_outlook_quarter_hours"}},
       {"Quarter-hours from now on whose day-ahead price is published."}},
      {utc_member<&R::outlook, &K::dearest, &Q::utc_s>().given<&R::outlook, &K::source>(),
       "dearest_utc",
       {.last = 201}},
      {member<&R::outlook, &K::dearest, &Q::centi_eur_per_mwh>().given<&R::outlook, &K::source>(),
       "dearest_centi",
       {.last = 202}},
      {utc_member<&R::outlook, &K::cheapest, &Q::utc_s>().given<&R::outlook, &K::source>(),
       "cheapest_utc",
       {.last = 203}},
      {member<&R::outlook, &K::cheapest, &Q::centi_eur_per_mwh>().given<&R::outlook, &K::source>(),
       "cheapest_centi",
       {.last = 204}},
      {utc_member<&R::outlook, &K::planned_utc_s>().given<&R::outlook, &K::source>(),
       "planned_utc",
       {.last = 194, .metrics = {62, "bess_outlook_planned_timestamp_seconds"}},
       {"Newest decision that was planned on published prices."}},
      {member<&R::outlook, &K::feed>().given<&R::outlook, &K::source>(),
       "day_ahead_status",
       {.csv = 64, .last = 195}},
      {member<&R::findings, &F::wrong_energy_e6>(),
       "wrong_energy_e6",
       {.csv = 65, .totals = 85, .metrics = {45, "bess_wrong_energy_ratio"}},
       {"Energy that flowed against or beyond orders, of the capacity, less 2.5 % a day; 0.2 is a "
        "trip.",
        1'000'000}},
      {member<&R::price_stands_in>(), "price_stands_in", {.csv = 66, .last = 57}},
      {member<&R::stand_in_centi_eur_per_mwh>().given<&R::price_stands_in>(),
       "stand_in_centi",
       {.csv = 67, .last = 58}},
      {member<&R::measurement, &B::lost_point>(),
       "lost_point",
       {.journal = 25, .csv = 68, .last = 35, .metrics = {46, "bess_lost_reading"}},
       {"1 + index in the register map of a protective reading that did not come; 0: none."}},
      {member<&R::measurement, &B::grid_unknown>()},
      {member<&R::measurement, &B::cut_point>(), "cut_point", {.csv = 69, .last = 36}},
  });
}

inline constexpr auto kRecordFields = make_record_fields();

// The table of what a run counts, beside that of a cycle: status.json and metrics
// hold both.

consteval auto make_run_fields() {
  using T = RunTotals;
  return std::to_array<Field<RunTotals>>({
      {member<&T::cycles>(),
       "cycles",
       {.totals = 11, .metrics = {32, "bess_cycles_total"}},
       {"Cycles since the start."}},
      {member<&T::written_orders>(), "written_orders", {.totals = 13}},
      {member<&T::battery_failures>(), "battery_failures", {.totals = 31}},
      {member<&T::price_failures>(), "price_failures", {.totals = 32}},
      {member<&T::records_dropped>(),
       "records_dropped",
       {.totals = 41, .metrics = {37, "bess_log_records_dropped_total"}},
       {"Records lost because the disk was too slow."}},
      {member<&T::disk_failures>(),
       "disk_failures",
       {.totals = 42, .metrics = {38, "bess_log_failures_total"}},
       {"Records that a log file refused."}},
      {member<&T::disk_is_slow>(), "disk_is_slow", {.totals = 51}},
      {member<&T::disk_is_failing>(), "disk_is_failing", {.totals = 52}},
      {member<&T::run_folder_is_failing>(), "run_folder_is_failing", {.totals = 53}},
  });
}

inline constexpr auto kRunFields = make_run_fields();

// Under which key status.json holds a member of CycleRecord or RunTotals: for who reads it back.

inline constexpr const char* kLastSection = "last";
inline constexpr const char* kTotalsSection = "totals";

struct StatusKey {
  const char* section;
  const char* name;
};

/// Where status.json holds the member at this path of CycleRecord or RunTotals. Does not compile
/// for a member that is not in it.
template <auto... kPath>
consteval StatusKey status_key() {
  const auto find = [](const auto& fields) -> StatusKey {
    for (const auto& field : fields) {
      if (field.access.id != path_id<kPath...>()) continue;
      if (field.place_in(&Places::last) > 0) return {kLastSection, field.name_in(&Places::last)};
      if (field.place_in(&Places::totals) > 0)
        return {kTotalsSection, field.name_in(&Places::totals)};
    }
    check_failed("no such key", __FILE__, __LINE__);
  };
  if constexpr (std::is_same_v<SourceOf<kPath...>, RunTotals>) {
    return find(kRunFields);
  } else {
    return find(kRecordFields);
  }
}

}  // namespace bess
