// Decision signature of this build (shared/decision_signature.h): student and guard replay the
// recorded days.
#pragma once

#include <cstdint>

#include "edge/core/control/safety_guard.h"
#include "shared/decision_signature.h"

namespace bess {

/// Guard inputs at a site without faults, with the student's action at this level or break-even
/// price, whichever is its context. The time zone must be set.
GuardInputs undisturbed_inputs(std::int64_t now_utc_s, std::int32_t soc_e4,
                               std::int32_t context_centi, std::int64_t price_minute_utc_s,
                               std::int32_t price_centi_eur_per_mwh);

DecisionSignature replay_recorded_days();

}  // namespace bess
