// What comes next, as far as it can be known: the next tick, what would be decided then if price
// and state of charge stayed, and what of the plan lies ahead. Beside the controller, from its
// newest record and its settings.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/core/control/control_types.h"
#include "edge/core/loop/control_settings.h"
#include "edge/records/why/margins.h"
#include "shared/host/json.h"

namespace bess {

/// From then on the plan keeps another reserve; 0: none.
struct ReserveChange {
  std::int64_t utc_s = 0;
  std::int16_t soc_e4 = 0;
};

struct NextDecision {
  std::int64_t utc_s = 0;    ///< the tick after `now`
  bool has_action = false;   ///< a price and a measurement are there
  Action action{};           ///< of student and thresholds, at the newest price and SoC
  std::int32_t power_w = 0;  ///< before ramp and limits
  Margins margins{};         ///< of that action; only with it
  /// Something else than the student decided last, and this ends it; empty: nothing did.
  std::string reason;
  std::string ends;
  std::vector<ReserveChange> reserve_changes;  ///< within a day
  int full_charge_in_days = -1;                ///< below 0: never; 0: due
};

NextDecision find_next_decision(const CycleRecord& newest, std::int64_t now_utc_s,
                                const ControlSettings& settings);

/// One line to three, each ended, in local time.
std::string next_decision_text(const NextDecision& next);
/// For Prometheus; empty without an action.
std::string next_decision_metrics(const NextDecision& next);
Json next_decision_json(const NextDecision& next);

}  // namespace bess
