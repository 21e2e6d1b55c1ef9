// The one demand that a student by outlook answers to besides the properties: the action never
// falls when the plan's break-even price rises. The plan holds that price from rising with SoC
// (shared/outlook/outlook_plan.h), so with property 3 the decision as a whole never rises with SoC.
#pragma once

#include "workstation/rules/rule.h"

namespace bess {

/// `rules` with it, unless it is among them.
RuleSet with_outlook_rule(const RuleSet& rules);

}  // namespace bess
