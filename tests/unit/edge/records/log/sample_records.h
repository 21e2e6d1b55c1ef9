// Hand-made decision records for the tests of outputs.
#pragma once

#include "edge/records/log/run_status.h"

namespace bess {

/// A distinct value in every field, so that a swapped or forgotten one shows.
inline CycleRecord full_record(std::int64_t cycle) {
  CycleRecord r;
  r.utc_s = 1'700'000'000 + 120 * cycle;
  r.cycle = cycle;
  r.mode = Mode::kHolding;
  r.has_measurement = true;
  r.measurement = {.soc_e4 = 1,
                   .power_w = -2,
                   .capacity_wh = 3,
                   .charge_w_max = 4,
                   .discharge_w_max = 5,
                   .temperature_min_deci_c = -6,
                   .temperature_max_deci_c = 7,
                   .alarm = true,
                   .off_grid = false,
                   .dispatch_active = true,
                   .has_order_power = true,
                   .order_power_w = -8,
                   .order_replaced = true,
                   .order_ended = true,
                   .warning = true};
  r.price = {.has_row = true,
             .minute_utc_s = 9,
             .price_centi_eur_per_mwh = -10,
             .received_monotonic_ns = 11,
             .fetch_us = 12,
             .status = Status::kTlsRefused,
             .large_step = true,
             .step_held = true,
             .held_centi_eur_per_mwh = -32};
  r.price_age_s = 13;
  r.has_student_action = true;
  r.student_action = Action::kCharge;
  r.ordered_power_w = -14;
  r.reason = Reason::kPriceQuarterHour;
  r.battery_status = Status::kNotApplied;
  r.written = true;
  r.decision_us = 15;
  r.write_us = 16;
  r.total_us = 17;
  r.missed_ticks = 18;
  r.counters = {.requests = 19,
                .failed_requests = 20,
                .reconnects = 21,
                .register_writes = 22,
                .unchanged_orders = 23,
                .flash_day = 24,
                .flash_writes_today = 25};
  r.deadline_misses = 26;
  r.unanswered_orders = 27;
  r.throughput = {.local_day = 28, .soc_moved_e4 = 29};
  r.price_level = {.centi_q16 = -30, .row_minute_utc_s = 31};
  r.context_class = 12;
  r.is_tripped = true;
  r.trip = {.reason = Reason::kSocMismatch, .utc_s = 1'700'000'032};
  r.weak_answers = 33;
  r.replaced_orders = 34;
  r.reversals = {.steps = 33, .direction = -1, .in_hour = 34};
  r.hold = {.held = true, .unreadable = true, .power_w = -35, .until_utc_s = 36};
  r.reserve_soc_e4 = 37;
  r.days_since_full = 38;
  r.site = {.has_grid_power = true,
            .grid_power_w = -39,
            .quarter_hour_import_wh = 40,
            .quarter_hour_battery_wh = 41,
            .order_cuts = 42,
            .meter_status = Status::kBadReply,
            .limit_status = Status::kMalformed,
            .house_is_implausible = true,
            .trust = {.is_mismatch = true,
                      .doubt = 49,
                      .pause_until_utc_s = 50,
                      .pause_s = 51,
                      .steps = 52,
                      .step_squares = 53,
                      .error_products = -54,
                      .error_squares = 55}};
  r.ended_orders = 43;
  r.lost_orders = {.orders = 44, .judged = 45, .lost = 46, .is_found = true};
  r.standing_price = {.minute_utc_s = 47, .centi_eur_per_mwh = -48, .unchanged_s = 49};
  r.price_frozen = true;
  r.findings = {.energy_share_percent = 50,
                .rest_loss_w = -51,
                .ramp_w_per_s = 52,
                .locked_readings = 69,
                .wrong_energy_e6 = 70};
  r.followed = {.is_judged = true, .power_w = -53, .age_s = 54, .soc_floor_e4 = 55};
  return r;
}

/// The longest text of every field.
inline CycleRecord longest_record() {
  CycleRecord r = full_record(0);
  r.utc_s = r.price.minute_utc_s = 4'102'444'800;
  r.cycle = INT64_MIN;
  r.mode = Mode::kStopping;
  r.measurement = {.soc_e4 = INT32_MIN,
                   .power_w = INT32_MIN,
                   .capacity_wh = INT32_MIN,
                   .charge_w_max = INT32_MIN,
                   .discharge_w_max = INT32_MIN,
                   .temperature_min_deci_c = INT32_MIN,
                   .temperature_max_deci_c = INT32_MIN,
                   .order_power_w = INT32_MIN};
  r.price.price_centi_eur_per_mwh = r.price.fetch_us = INT32_MIN;
  r.price.held_centi_eur_per_mwh = INT32_MIN;
  r.price.received_monotonic_ns = INT64_MIN;
  r.price.status = r.battery_status = Status::kNotExpressible;
  r.price_age_s = r.ordered_power_w = r.decision_us = r.write_us = r.total_us = INT32_MIN;
  r.student_action = Action::kDischarge;
  r.reason = Reason::kUncontrolledPower;
  r.missed_ticks = r.deadline_misses = r.unanswered_orders = INT32_MIN;
  r.throughput = {.local_day = INT32_MIN, .soc_moved_e4 = INT32_MIN};
  r.price_level = {.centi_q16 = INT64_MIN, .row_minute_utc_s = INT64_MIN};
  r.context_class = INT16_MIN;
  r.trip = {.reason = Reason::kUncontrolledPower, .utc_s = 4'102'444'800};
  r.weak_answers = r.replaced_orders = r.ended_orders = INT32_MIN;
  r.lost_orders = {.orders = UINT32_MAX, .judged = INT16_MIN, .lost = INT16_MIN};
  r.reversals = {.steps = UINT32_MAX, .direction = INT16_MIN, .in_hour = INT16_MIN};
  r.hold = {.held = true, .power_w = INT32_MIN, .until_utc_s = UINT32_MAX};
  r.reserve_soc_e4 = r.days_since_full = INT16_MIN;
  r.site = {.has_grid_power = true,
            .grid_power_w = INT32_MIN,
            .quarter_hour_import_wh = INT32_MIN,
            .quarter_hour_battery_wh = INT32_MIN,
            .order_cuts = INT32_MIN,
            .meter_status = Status::kNotExpressible,
            .limit_status = Status::kNotExpressible,
            .house_is_implausible = true,
            .trust = {.is_mismatch = true,
                      .doubt = INT32_MIN,
                      .pause_until_utc_s = 4'102'444'800,
                      .pause_s = INT32_MIN,
                      .steps = INT32_MIN,
                      .step_squares = INT64_MIN,
                      .error_products = INT64_MIN,
                      .error_squares = INT64_MIN}};
  r.standing_price = {INT64_MIN, INT32_MIN, INT32_MIN};
  r.counters = {INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN, INT64_MIN, INT32_MIN};
  r.counters.requests = 0;  // requests - failed_requests must not overflow
  r.counters.failed_requests = INT64_MAX;
  return r;
}

/// Enumerator i of every enumeration, cyclically: kReasonCount of them show each name.
inline CycleRecord record_with_enumerators(int i) {
  CycleRecord r = full_record(i);
  r.mode = static_cast<Mode>(i % kModeCount);
  r.student_action = static_cast<Action>(i % kActionCount);
  r.reason = static_cast<Reason>(i % kReasonCount);
  r.battery_status = static_cast<Status>(i % kStatusCount);
  r.price.status = static_cast<Status>((i + 5) % kStatusCount);
  r.site.meter_status = static_cast<Status>((i + 7) % kStatusCount);
  return r;
}

/// A distinct value in every total as well.
inline RunTotals full_totals(const CycleRecord& last) {
  RunTotals t;
  t.cycles = 101;
  for (std::size_t i = 0; i < t.cycles_by_reason.size(); ++i) {
    t.cycles_by_reason[i] = 200 + static_cast<std::int64_t>(i);
  }
  t.written_orders = 102;
  t.battery_failures = 103;
  t.price_failures = 104;
  t.records_dropped = 105;
  t.disk_failures = 106;
  t.disk_is_slow = true;
  t.disk_is_failing = false;
  t.last = last;
  return t;
}

inline RunIdentity sample_identity() {
  RunIdentity id;
  id.version = "1.2.3";
  id.student_hash = 0xABCD;
  id.student_provenance = "trained on \"prices\"\\today\n";
  id.map = "alphaess";
  id.variant = "block";
  id.battery = "127.0.0.1:502 unit 85";
  id.control = true;
  id.pid = 4711;
  id.start_utc_s = 1'679'788'800;
  id.wear = {.used_life_percent = 30, .spare_level = 1, .file_system_errors = 2};
  return id;
}

}  // namespace bess
