// Integer form of the stochastic program with an outlook, used by workstation and edge
// (shared/outlook): half as many bins, each two adjacent bins of the chain.
#pragma once

#include "shared/outlook/outlook_model.h"
#include "workstation/policy/planners/outlook_program.h"

namespace bess {

/// Throws UserError for values outside the integer ranges.
OutlookModel outlook_integers(const OutlookProgram& program);

}  // namespace bess
