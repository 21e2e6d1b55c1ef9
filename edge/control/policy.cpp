#include "edge/control/policy.h"

#include "shared/nn/exported_student.h"

namespace bess {

ContextKind student_context_kind() { return kExportedStudent.context.kind; }

Action decide_with_student(const LocalMinute& now, const PriceLevel& level, std::int32_t soc_e4,
                           std::int32_t price_centi_eur_per_mwh) {
  const std::int16_t context_class =
      kExportedStudent.context.class_of(now.month, level.centi_eur_per_mwh());
  return kExportedStudent.decide(
      make_lattice_state(now, context_class, soc_e4, price_centi_eur_per_mwh));
}

int count_student_self_check_failures() { return count_exported_self_check_failures(); }

int student_self_check_count() { return kExportedSelfCheckCount; }

const char* student_provenance() { return BESS_STUDENT_PROVENANCE; }

std::uint32_t student_hash() { return BESS_STUDENT_WEIGHTS_HASH; }

PriceThresholds student_thresholds() { return kExportedThresholds; }

}  // namespace bess
