// What a student by outlook learns from: steps of the training days with what the teacher, the
// program that plans on day-ahead prices and what a network adds to it, would do there. Its values
// are no function of the student's five inputs, so they stand below them.
#pragma once

#include "workstation/correction/distil.h"

namespace bess {

/// [5 inputs and 3 action values x states], as Teacher::action_values() reads them. Of states that
/// the teacher's policy meets on the training days, and some at another price and SoC. All but the
/// first pass move each day's prices and its break-even prices alike: what to do stays the same.
Matrix outlook_lessons(const Teacher& teacher, const MarketSteps& market,
                       const BatteryParameters& battery, const DistilOptions& options);

}  // namespace bess
