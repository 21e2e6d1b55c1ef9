// An operator's rules as rows of the constraint layer, on one context lattice: for each state in a
// rule's box what ScoreRows asks of u and v. Rules on directions say nothing of one state, and "not
// idle" is not convex: they give no rows, and are the proof's to find.
#pragma once

#include <vector>

#include "workstation/correction/correction_layer.h"
#include "workstation/correction/difference_row.h"
#include "workstation/rules/rule.h"

namespace bess {

/// `context` gives quarter-hour and class; state = price index * SoCs + SoC index. Rows bear the
/// rules' names. No rule holds: no row.
std::vector<DifferenceRow> lattice_rule_rows(const RuleSet& rules, ContextKind kind,
                                             const LatticeState& context, const LatticeAxes& axes,
                                             double margin);

}  // namespace bess
