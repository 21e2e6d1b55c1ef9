// What bounds the battery's wear by orders: cycles a day, and reversals an hour.
#pragma once

#include "edge/control/cycle_budget.h"
#include "edge/control/reversal_cap.h"
#include "edge/loop/parts/cycle_part.h"

namespace bess {

struct CycleBudgetPart : CyclePart {
  explicit CycleBudgetPart(std::int32_t per_day_max_e4) : budget(per_day_max_e4) {}

  void restore(const CycleRecord& before) { budget.restore(before.throughput); }
  void observe(const Reading& now) {
    if (now.look == Look::kCheck) return;
    if (!now.is_read) return budget.forget_soc();
    const std::int32_t today = local_day_of(local_minute_of(now.utc_s));
    budget.update(today, now.response.measurement.soc_e4, now.drives);
  }
  void put(const Moment&, CycleRecord&, GuardInputs& in) {
    in.cycle_budget_spent = budget.is_spent();
  }
  void report(CycleRecord& record) const { record.throughput = budget.today(); }

  CycleBudget budget;
};

struct ReversalCapPart : CyclePart {
  explicit ReversalCapPart(std::int32_t per_hour_max) : cap(per_hour_max) {}

  void restore(const CycleRecord& before) { cap.restore(before.reversals, before.utc_s); }
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick) cap.advance(record.utc_s);
    in.barred_direction = cap.barred_direction();
  }
  void note(std::int32_t power_w) { cap.note(power_w); }
  void report(CycleRecord& record) const { record.reversals = cap.history(); }

  ReversalCap cap;
};

}  // namespace bess
