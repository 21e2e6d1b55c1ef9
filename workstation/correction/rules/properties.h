// The three properties [SPEC 5] as built-in rules in the form of operator's rules: charge at or
// below the low price, discharge at or above the high price, and two directions (property 3: price
// and SoC).
#pragma once

#include <string>

#include "workstation/correction/rules/rule.h"

namespace bess {

// Additional rule of a student with the outlook context: the action never falls when the plan's
// break-even price rises. In the plan that price never rises with SoC
// (shared/outlook/outlook_plan.h), so with property 3 the decision never rises with SoC.

/// `rules` with the additional rule, unless already present.
RuleSet with_outlook_rule(const RuleSet& rules);

inline constexpr int kPropertyCount = 3;
inline constexpr std::size_t kBuiltInRuleCount = 4;

/// The four built-in rules for these thresholds.
RuleSet built_in_rules(const PriceThresholds& thresholds);
/// The built-in rules, then the operator's.
RuleSet with_built_in(const PriceThresholds& thresholds, const RuleSet& rules);
/// The same with the given thresholds, as far as the rules do not replace them.
RuleSet with_properties(const RuleSet& rules, const PriceThresholds& thresholds);

/// "charge at or below -500 EUR/MWh"; `property` is 1 to 3.
std::string property_text(int property, const PriceThresholds& thresholds);

}  // namespace bess
