// Student interface of the control loop: the exported integer net of this build.
#pragma once

#include <cstdint>

#include "edge/core/control/control_types.h"
#include "shared/action.h"
#include "shared/context_classes.h"
#include "shared/decision_rule.h"
#include "shared/features.h"
#include "shared/outlook/outlook_model.h"
#include "shared/price_thresholds.h"
#include "shared/training_period.h"

namespace bess {

/// Context classes of the student.
const ContextClasses& student_context();
/// Plan model of a student by outlook; null for other contexts.
const OutlookModel* student_outlook();
/// Context class of the student, 1..12, from the trailing level or the plan's break-even price, in
/// 0.01 EUR/MWh; by month neither is used.
std::int16_t student_context_class(const LocalMinute& now, std::int32_t context_centi);
/// Source value of a cycle's context class.
inline std::int32_t context_centi_of(const CycleRecord& record) {
  return student_outlook() != nullptr ? record.outlook.break_even_centi
                                      : record.price_level.centi_eur_per_mwh();
}
/// Line of decision_signature.txt beside the weights; empty without that file.
const char* expected_signature();
Action decide_with_student(const LatticeState& state);

/// Actions that the operator's exported rules permit.
RuleLimits student_rule_limits(const LocalMinute& now, const LatticeState& state,
                               std::int32_t price_centi_eur_per_mwh);
/// Number of rules that the guard enforces.
int guard_rule_count();
const char* guard_rule_name(int index);
/// True if that rule applies there.
bool guard_rule_holds(int index, const LocalMinute& now, const LatticeState& state,
                      std::int32_t price_centi_eur_per_mwh);

/// 0 if this machine reproduces every golden vector of the weight header bit for bit.
int count_student_self_check_failures();
int student_self_check_count();
const char* student_provenance();
TrainingPeriod student_training();
/// In 0.01 full cycles, as the exporter expects them; negative: unknown.
int student_cycles_per_day_e2();
/// Hash of the weights, and of the guard's rules and the outlook if present.
std::uint32_t student_hash();
/// Thresholds for which the student was proved; the guard may use others.
PriceThresholds student_thresholds();

}  // namespace bess
