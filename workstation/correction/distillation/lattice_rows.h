// Rules as rows of the constraint layer on one context lattice, for built-in and operator's rules
// alike. A rule on actions gives the rows of ScoreRows at each state of its box. A direction
// requires that u and v fall from each state to its neighbour in price or SoC. "Not idle" is not
// convex, and other directions leave the lattice: they give no rows; the proof finds violations.
#pragma once

#include <vector>

#include "workstation/correction/distillation/constraint_layer.h"
#include "workstation/correction/distillation/correction_layer.h"
#include "workstation/correction/rules/rule.h"

namespace bess {

/// `context` gives quarter-hour and class; state = price index * SoCs + SoC index. Rows carry the
/// rules' names. Without a rule in force the list is empty.
std::vector<DifferenceRow> lattice_rows(const RuleSet& rules, ContextKind kind,
                                        const LatticeState& context, const LatticeAxes& axes,
                                        const CorrectionOptions& options);

/// The paper's three properties, as in CorrectionLayer.
std::vector<DifferenceRow> property_rows(const CorrectionOptions& options, const LatticeAxes& axes);

}  // namespace bess
