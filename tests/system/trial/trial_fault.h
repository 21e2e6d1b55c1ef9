// Faults of a trial battery: wrong power, wrong display, and the affected ticks.
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
  double honest_w = 0;  ///< power of a healthy battery now
  double rated_w = 0;
  std::int64_t now_s = 0;
};

struct ShownView {
  bool is_dispatched = false;
  double ordered_w = 0;
  double flow_w = 0;         ///< real power
  double honest_w = 0;       ///< power without the fault
  double charged_frac = 0;   ///< real charge since the fault began, share of the capacity
  std::int64_t fault_s = 0;  ///< since it began
  const BatteryMeasurement& at_fault;
};

struct TrialFault {
  const char* name;
  double (*flow)(const FlowView&) = nullptr;                      ///< null: healthy
  void (*show)(const ShownView&, BatteryMeasurement&) = nullptr;  ///< null: the truth
};

/// Of the ticks since the fault began.
struct FaultTimes {
  int every = 1;           ///< at the first, then at every Nth
  double probability = 0;  ///< above 0: probability at each tick, instead of `every`
};

std::span<const TrialFault> trial_faults();
/// Ends the program if there is no fault of that name.
const TrialFault& trial_fault(std::string_view name);

}  // namespace bess::trial
