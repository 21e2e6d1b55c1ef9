// The student as the control loop sees it: the exported integer net that this build carries.
#pragma once

#include <cstdint>

#include "shared/action.h"
#include "shared/context_classes.h"
#include "shared/features.h"
#include "shared/price_level.h"
#include "shared/price_thresholds.h"

namespace bess {

/// What the student's context class is made from.
const ContextClasses& student_context();
/// The class that the student is given, 1..12.
std::int16_t student_context_class(const LocalMinute& now, const PriceLevel& level);
/// What the exported student would do.
Action decide_with_student(const LatticeState& state);

/// 0 when this machine computes every golden vector of the weight header bit for bit.
int count_student_self_check_failures();
int student_self_check_count();
const char* student_provenance();
std::uint32_t student_hash();
/// What the exported student was proved for; the guard's own thresholds may be others.
PriceThresholds student_thresholds();

}  // namespace bess
