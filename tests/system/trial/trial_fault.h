// What a battery of the trial does wrong: what flows instead of what an honest one would let flow,
// what it shows instead of what is true, and at which ticks.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <string_view>

#include "edge/core/control/control_types.h"

namespace bess::trial {

/// Powers at the grid side, charging positive.
struct FlowView {
  double ordered_w = 0;           ///< in force; 0 without an order
  double ordered_before_w = 0;    ///< the order before this one
  double ordered_at_fault_w = 0;  ///< when the fault began
  std::int64_t order_age_s = 0;
  double honest_w = 0;  ///< what an honest battery would let flow now
  double rated_w = 0;
  std::int64_t now_s = 0;
};

struct ShownView {
  bool is_dispatched = false;
  double ordered_w = 0;
  double flow_w = 0;         ///< what really flows
  double honest_w = 0;       ///< what would
  double charged_frac = 0;   ///< of its capacity, really, since the fault began
  std::int64_t fault_s = 0;  ///< since it began
  const BatteryMeasurement& at_fault;
};

struct TrialFault {
  const char* name;
  double (*flow)(const FlowView&) = nullptr;                      ///< null: honest
  void (*show)(const ShownView&, BatteryMeasurement&) = nullptr;  ///< null: the truth
};

/// Of the ticks since the fault began.
struct FaultTimes {
  int every = 1;           ///< at the first, then at every so manieth
  double probability = 0;  ///< above 0: at each with this, instead of `every`
};

std::span<const TrialFault> trial_faults();
/// Ends the program where there is none of that name.
const TrialFault& trial_fault(std::string_view name);

}  // namespace bess::trial
