// The three properties [SPEC 5] as built-in rules, in the form of an operator's rule: charge at or
// below the low price, discharge at or above the high one, and two directions, since property 3
// speaks of price and SoC.
#pragma once

#include <string>

#include "workstation/correction/rules/rule.h"

namespace bess {

// The one demand that a student by outlook answers to besides the properties: the action never
// falls when the plan's break-even price rises. The plan holds that price from rising with SoC
// (shared/outlook/outlook_plan.h), so with property 3 the decision as a whole never rises with SoC.

/// `rules` with it, unless it is among them.
RuleSet with_outlook_rule(const RuleSet& rules);

inline constexpr int kPropertyCount = 3;
inline constexpr std::size_t kBuiltInRuleCount = 4;

/// The four, for these thresholds.
RuleSet built_in_rules(const PriceThresholds& thresholds);
/// They, and then the rules.
RuleSet with_built_in(const PriceThresholds& thresholds, const RuleSet& rules);
/// The same with the thresholds that the rules leave of these.
RuleSet with_properties(const RuleSet& rules, const PriceThresholds& thresholds);

/// "charge at or below -500 EUR/MWh"; of property 1 to 3.
std::string property_text(int property, const PriceThresholds& thresholds);

}  // namespace bess
