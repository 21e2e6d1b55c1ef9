#include "edge/control/policy.h"

#include "shared/nn/exported_student.h"

namespace bess {

const ContextClasses& student_context() { return kExportedStudent.context; }

std::int16_t student_context_class(const LocalMinute& now, const PriceLevel& level) {
  return kExportedStudent.context.class_of(now.month, level.centi_eur_per_mwh());
}

Action decide_with_student(const LatticeState& state) { return kExportedStudent.decide(state); }

int count_student_self_check_failures() { return count_exported_self_check_failures(); }

int student_self_check_count() { return kExportedSelfCheckCount; }

const char* student_provenance() { return BESS_STUDENT_PROVENANCE; }

std::uint32_t student_hash() { return BESS_STUDENT_WEIGHTS_HASH; }

PriceThresholds student_thresholds() { return kExportedThresholds; }

}  // namespace bess
