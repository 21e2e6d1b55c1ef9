// The student as the control loop sees it: the exported integer net that this build carries.
#pragma once

#include <cstdint>

#include "shared/action.h"
#include "shared/features.h"
#include "shared/price_thresholds.h"

namespace bess {

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
