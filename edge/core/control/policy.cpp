#include "edge/core/control/policy.h"

#include "shared/nn/exported_student.h"
#include "shared/outlook/exported_outlook.h"

namespace bess {
const ContextClasses& student_context() { return kExportedStudent.context; }

const OutlookModel* student_outlook() { return exported_outlook(); }

std::int16_t student_context_class(const LocalMinute& now, std::int32_t context_centi) {
  return kExportedStudent.context.class_of(now.month, context_centi);
}

Action decide_with_student(const LatticeState& state) { return kExportedStudent.decide(state); }

RuleLimits student_rule_limits(const LocalMinute& now, const LatticeState& state,
                               std::int32_t price_centi_eur_per_mwh) {
  return rule_limits_at(kExportedGuardRules, rule_point(now, state, price_centi_eur_per_mwh));
}

bool guard_rule_holds(int index, const LocalMinute& now, const LatticeState& state,
                      std::int32_t price_centi_eur_per_mwh) {
  const RulePoint point = rule_point(now, state, price_centi_eur_per_mwh);
  int i = 0;
  for (const GuardRule& rule : kExportedGuardRules) {
    if (i++ == index) return rule.box.contains(point);
  }
  return false;
}

int guard_rule_count() { return kExportedGuardRuleCount; }

const char* guard_rule_name(int index) { return exported_guard_rule_name(index); }

int count_student_self_check_failures() {
  return count_exported_self_check_failures() + count_exported_outlook_failures();
}

int student_self_check_count() {
  return kExportedSelfCheckCount + kExportedRuleCheckCount + kExportedOutlookCheckCount;
}

const char* student_provenance() { return BESS_STUDENT_PROVENANCE; }

TrainingPeriod student_training() { return kExportedTraining; }

int student_cycles_per_day_e2() { return BESS_STUDENT_CYCLES_PER_DAY_E2; }

std::uint32_t student_hash() { return hash_by_outlook(kExportedHash, kExportedOutlookHash); }

PriceThresholds student_thresholds() { return kExportedThresholds; }

}  // namespace bess
