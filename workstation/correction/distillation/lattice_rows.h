// Rules as rows of the constraint layer, on one context lattice: of the built-in ones and of an
// operator's by the same code. A rule on actions asks of u and v what ScoreRows says, at each state
// of its box; a direction asks that they fall from each state to its neighbour in price or SoC.
// "Not idle" is not convex, and other directions leave the lattice: they give no rows, and are the
// proof's to find.
#pragma once

#include <vector>

#include "workstation/correction/distillation/constraint_layer.h"
#include "workstation/correction/distillation/correction_layer.h"
#include "workstation/correction/rules/rule.h"

namespace bess {

/// `context` gives quarter-hour and class; state = price index * SoCs + SoC index. Rows bear the
/// rules' names. No rule holds: no row.
std::vector<DifferenceRow> lattice_rows(const RuleSet& rules, ContextKind kind,
                                        const LatticeState& context, const LatticeAxes& axes,
                                        const CorrectionOptions& options);

/// The paper's three properties, as the CorrectionLayer demands them.
std::vector<DifferenceRow> property_rows(const CorrectionOptions& options, const LatticeAxes& axes);

}  // namespace bess
