// Does the battery do as it is told? What an earlier run has found by its readings, short of a
// trip, is found again: who kills the program between two of them hides nothing.
#pragma once

#include "edge/loop/parts/cycle_part.h"
#include "edge/loop/recalled_time.h"
#include "edge/supervision/supervision.h"

namespace bess {

struct SupervisionPart : CyclePart {
  SupervisionPart(const SupervisionSettings& settings, std::int32_t lead_s)
      : supervision(settings), read_lead_s(lead_s) {}

  void restore(const CycleRecord& before) {
    supervision.restore(before.trip);
    const bool was_cleared = before.is_tripped && !before.trip.is_set();
    supervision.restore(was_cleared ? ResponseFindings{} : before.findings);
    supervision.restore(before.lost_orders, before.utc_s + time.ahead_s());
  }
  void recall(const CycleRecord& then, bool is_under_control) {
    if (!is_under_control || !then.has_measurement) return;
    supervision.recall({.utc_s = then.utc_s - read_lead_s,
                        .steady_s = time.steady_s(then, read_lead_s),
                        .is_driven = then.followed.is_judged,
                        .ordered_power_w = then.followed.power_w,
                        .order_age_s = then.followed.age_s,
                        .soc_floor_e4 = then.followed.soc_floor_e4,
                        .measurement = then.measurement});
    if (then.mode == Mode::kRunning) supervision.on_ordered(then.utc_s, then.battery_status);
  }
  void observe(const Reading& now) {
    const std::int32_t capacity_wh = now.response.measurement.capacity_wh;
    if (!now.is_under_control) return;
    if (now.look == Look::kCut) return supervision.note_power(now.response);
    if (now.look == Look::kCheck && now.is_read) return supervision.note_between(now.response);
    if (!now.ends_step()) return;
    const bool is_lost = now.response.measurement.lost_point != 0;
    if (is_lost && now.is_read) {
      supervision.note_unread(now.utc_s, now.drives, true);
    } else if (now.is_read) {
      supervision.observe(now.response, now.holds_nothing);
    } else if (capacity_wh > 0) {
      supervision.note_capacity(capacity_wh);
    } else {
      supervision.note_unread(now.utc_s, now.drives, is_temporary(now.status));
    }
  }
  void put(const Moment&, CycleRecord&, GuardInputs& in) {
    in.supervision = supervision.stop_reason();
  }
  void report(CycleRecord& record) const {
    const ResponseMonitor& response = supervision.response();
    record.unanswered_orders = response.unanswered_orders();
    record.weak_answers = response.weak_answers();
    record.findings = response.findings();
    record.replaced_orders = supervision.lost_orders().replaced();
    record.ended_orders = supervision.lost_orders().ended();
    record.lost_orders = supervision.lost_orders().history();
    record.is_tripped = supervision.trip().is_set();
    record.trip = supervision.trip();
  }

  Supervision supervision;
  RecalledTime time;
  std::int32_t read_lead_s;
};

}  // namespace bess
