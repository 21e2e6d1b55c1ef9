// The signature of what this build decides: student and guard replay the same recorded prices on
// fixed days, and one number stands for all their orders. It belongs to the weights and to the code
// that decides: a change of either shows, and every machine must find the same number.
//
// Two days of prices are replayed in each month of a year, in spring and autumn on the days of the
// clock change; a student by outlook plans each of them on made-up day-ahead prices. The battery's
// energy is counted in integers, so nothing here rounds.
#pragma once

#include <cstdint>

#include "edge/control/safety_guard.h"

namespace bess {

/// What the guard is given at a site where nothing is wrong, the student's wish included at this
/// level or break-even price, whichever is its context. The time zone must be set.
GuardInputs undisturbed_inputs(std::int64_t now_utc_s, std::int32_t soc_e4,
                               std::int32_t context_centi, std::int64_t price_minute_utc_s,
                               std::int32_t price_centi_eur_per_mwh);

struct DecisionSignature {
  std::uint64_t signature = 0;  ///< over (UTC seconds, ordered W) of every decision, in order
  int decisions = 0;
  int charging = 0;
  int discharging = 0;
};

/// Takes a fraction of a second, by outlook some 1.5 s on a PC. The time zone must be set.
DecisionSignature replay_recorded_days();

}  // namespace bess
