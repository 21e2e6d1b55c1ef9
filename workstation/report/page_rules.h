// The operator's rules as the page draws and counts them (page/rule_boxes.js): where each holds on
// the lattice, what it asks, and who is held to it.
#pragma once

#include "shared/host/json.h"
#include "workstation/rules/rule.h"

namespace bess {

/// A list of objects, one a rule, in order:
///   name, text, held_by, binds_student
///   hours      [first quarter-hour, how many], past midnight too
///   classes    bit c - 1, of the student's context; all where it does not see the months of
///              the rule
///   soc        [first, last] lattice index
///   price      [first, last] EUR/MWh of the lattice; left out for a rule that lies outside it
///   forbidden  actions that break it; left out for what no single state breaks, and for
///              thresholds, which are properties 1 and 2
///   direction  {input, sign} as Direction has them; of such a rule alone, which has no box
Json rules_json(const RuleSet& rules, ContextKind kind);

}  // namespace bess
