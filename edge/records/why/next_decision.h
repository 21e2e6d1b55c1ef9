// Next decision, as far as it is known: the decision at the next tick with constant price and SoC,
// and the planned reserves and full charges. From the newest record and the settings, outside the
// controller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/core/control/control_types.h"
#include "edge/core/loop/control_settings.h"
#include "edge/records/why/margins.h"
#include "shared/host/json.h"

namespace bess {

/// Change of the planned reserve; 0 = none.
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
  /// Reason that overrides the student, and its end condition; empty = none.
  std::string reason;
  std::string ends;
  std::vector<ReserveChange> reserve_changes;  ///< within a day
  int full_charge_in_days = -1;                ///< negative: never; 0: due
};

NextDecision find_next_decision(const CycleRecord& newest, std::int64_t now_utc_s,
                                const ControlSettings& settings);

/// One to three lines with line ends, in local time.
std::string next_decision_text(const NextDecision& next);
/// Prometheus text; empty without an action.
std::string next_decision_metrics(const NextDecision& next);
Json next_decision_json(const NextDecision& next);

}  // namespace bess
