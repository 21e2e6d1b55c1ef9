// Decision inputs in addition to those of the cycle parts: the record's reading and price, and the
// student.
#pragma once

#include <cstdint>
#include <optional>

#include "edge/core/control/level_start.h"
#include "edge/core/control/policy.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/loop/cycle_parts.h"

namespace bess {

/// `now_utc_s`: the tick, or later if more than the price wait has passed.
inline GuardInputs guard_inputs(const CycleRecord& record, std::int64_t now_utc_s,
                                std::int32_t price_age_s_max) {
  // Suspended between reading and deciding: a reading may be as old as a price, not older.
  const bool is_recent = now_utc_s - record.utc_s <= price_age_s_max;
  return {.now_utc_s = now_utc_s,
          .link_ok = record.has_measurement && is_recent,
          .measurement = record.measurement,
          .has_price = record.price.has_row,
          .price_minute_utc_s = record.price.minute_utc_s,
          .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh};
}

/// Replaces a price that is too old to trade on by an estimate, if the guard permits.
inline void allow_stand_in(const SafetyGuard& guard, const PriceLevel& level, CycleRecord& record,
                           GuardInputs& in) {
  if (!level.is_known() || !guard.may_stand_in(in)) return;
  in.price_centi_eur_per_mwh = stand_in_centi(in.price_centi_eur_per_mwh, level.centi_eur_per_mwh(),
                                              price_age_s(in.now_utc_s, in.price_minute_utc_s));
  in.price_stands_in = record.price_stands_in = true;
  record.stand_in_centi_eur_per_mwh = in.price_centi_eur_per_mwh;
}

/// Student's action and rule limits, if battery and price are known.
inline void ask_student(const PriceLevel& level, OutlookPart& outlook, CycleRecord& record,
                        GuardInputs& in) {
  if (!record.has_measurement || !record.price.has_row) return;
  const std::int32_t price_centi = decided_price_centi(record);
  const LocalMinute now = local_minute_of(record.utc_s);
  record.context_class = student_context_class(now, outlook.context_centi(level, record));
  const LatticeState state =
      make_lattice_state(now, record.context_class, record.measurement.soc_e4, price_centi);
  record.student_action = decide_with_student(state);
  record.has_student_action = true;
  in.student_action = record.student_action;
  in.rules = student_rule_limits(now, state, price_centi);
}

/// A device that responds with a wrong identity or capacity was stopped for that, not because it
/// could not be read.
constexpr Reason cause_of(Reason reason, std::optional<Reason> supervision, Status battery_status) {
  const bool is_implausible = reason == Reason::kLink && battery_status == Status::kImplausible;
  return is_implausible ? supervision.value_or(reason) : reason;
}

inline void note_price_age(std::int64_t utc_s, CycleRecord& record) {
  if (!record.price.has_row) return;
  record.price_age_s = static_cast<std::int32_t>(price_age_s(utc_s, record.price.minute_utc_s));
}

}  // namespace bess
