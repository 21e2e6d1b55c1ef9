// The student as the control loop sees it: the exported integer net that this build carries.
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

/// What the student's context class is made from.
const ContextClasses& student_context();
/// Of the plan that gives a student by outlook its context; null where the context is another.
const OutlookModel* student_outlook();
/// The class that the student is given, 1..12, of the trailing level or of the plan's break-even
/// price, whichever is its context, in hundredths of EUR/MWh; by month neither counts.
std::int16_t student_context_class(const LocalMinute& now, std::int32_t context_centi);
/// What a cycle's class was made of.
inline std::int32_t context_centi_of(const CycleRecord& record) {
  return student_outlook() != nullptr ? record.outlook.break_even_centi
                                      : record.price_level.centi_eur_per_mwh();
}
/// What the exported student would do.
Action decide_with_student(const LatticeState& state);

/// What the operator's rules that came with the student leave to decide.
RuleLimits student_rule_limits(const LocalMinute& now, const LatticeState& state,
                               std::int32_t price_centi_eur_per_mwh);
/// Of the rules that the guard enforces.
int guard_rule_count();
const char* guard_rule_name(int index);
/// Whether that rule has a say there.
bool guard_rule_holds(int index, const LocalMinute& now, const LatticeState& state,
                      std::int32_t price_centi_eur_per_mwh);

/// 0 when this machine computes every golden vector of the weight header bit for bit.
int count_student_self_check_failures();
int student_self_check_count();
const char* student_provenance();
TrainingPeriod student_training();
/// In hundredths, as the exporter expects them; negative: not known.
int student_cycles_per_day_e2();
/// Of the weights, and of the rules that the guard enforces and the outlook where there are any.
std::uint32_t student_hash();
/// What the exported student was proved for; the guard's own thresholds may be others.
PriceThresholds student_thresholds();

}  // namespace bess
