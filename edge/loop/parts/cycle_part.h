// A part of the cycle is whatever has a say in it besides price and student: site, hold, reserve,
// full charge, frozen price, budget, cap, supervision. This is the face of all. The loop asks them
// in the order of cycle_parts.h, and the record that a part reports to is the state that the next
// run restores it from. One more is one file here and one row there; it derives from CyclePart and
// hides what it needs. Nothing is virtual, nothing allocates.
#pragma once

#include <cstdint>

#include "edge/control/control_types.h"
#include "edge/control/safety_guard.h"
#include "edge/site/site_limits.h"
#include "edge/supervision/response.h"

namespace bess {

enum class Look : std::uint8_t {
  kTick,   ///< of a cycle, before its decision
  kLast,   ///< of a run, after its release
  kCheck,  ///< between two ticks: is the order still borne?
  kCut     ///< just before it is taken back
};

/// The battery was read, or could not be.
struct Reading {
  Look look = Look::kTick;
  std::int64_t utc_s = 0;       ///< the tick's; between two, now
  Status status = Status::kOk;  ///< of the reading
  bool is_read = false;
  bool is_under_control = false;
  bool holds_nothing = false;  ///< what the battery follows is not ours
  bool drives = false;         ///< an order of ours is in force, and not of 0 W
  Response response{};

  /// What flowed since the one before belongs to one order.
  [[nodiscard]] bool ends_step() const { return look == Look::kTick || look == Look::kLast; }
};

/// When the guard is asked.
struct Moment {
  bool is_tick = true;  ///< false: the order in force is held against the limits as they are now
  Margin margin = Margin::kWhole;
  std::int32_t power_w = 0;  ///< rated
};

struct CyclePart {
  /// The newest record of an earlier run.
  void restore(const CycleRecord&) {}
  /// A cycle of an earlier run, oldest first and before `restore`.
  void recall(const CycleRecord&, bool /*is_under_control*/) {}
  void observe(const Reading&) {}
  /// What the guard is to know; what holds in this cycle alone is noted in its record as well. A
  /// limit of one more reason needs nothing of the guard: `in.site.limit_charge(power_w, reason)`,
  /// `limit_discharge` or `forbid`.
  void put(const Moment&, CycleRecord&, GuardInputs&) {}
  /// That power is ordered now.
  void note(std::int32_t) {}
  void report(CycleRecord&) const {}
};

}  // namespace bess
