// Hand-made decision records for the tests of outputs.
#pragma once

#include <algorithm>
#include <cstring>

#include "edge/records/log/record_fields.h"
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

/// Sets a field to its value with the longest text; a flag is set.
inline void set_longest(const Field<CycleRecord>& field, CycleRecord& r) {
  const MemberAccess<CycleRecord>& access = field.access;
  std::int64_t value = -1 - (INT64_MAX >> (64 - 8 * access.bytes));
  if (access.kind == MemberKind::kFlag) value = 1;
  if (access.kind == MemberKind::kUtc) value = 4'102'444'800;
  if (access.kind == MemberKind::kName) {
    value = 0;
    for (std::int64_t code = 0; access.set(r, code); ++code) {
      if (std::strlen(access.name_of(code)) > std::strlen(access.name_of(value))) value = code;
    }
  }
  access.set(r, value);
}

/// The longest text of every field.
inline CycleRecord longest_record() {
  CycleRecord r;
  for (const auto& field : kRecordFields) set_longest(field, r);
  for (const auto& flag : kRecordFields) {  // "false" is longer, except where a value needs it
    if (flag.access.kind != MemberKind::kFlag) continue;
    flag.access.set(r, 0);
    const auto exists = [&r](const auto& field) { return field.exists_in(r); };
    if (!std::ranges::all_of(kRecordFields, exists)) flag.access.set(r, 1);
  }
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
