// The stochastic program with an outlook as the integers that workstation and edge plan in
// (shared/outlook): half as many bins, each two neighbours of the chain's.
#pragma once

#include "shared/outlook/outlook_model.h"
#include "workstation/policy/planners/outlook_program.h"

namespace bess {

/// Throws UserError when the program has numbers that no market has.
OutlookModel outlook_integers(const OutlookProgram& program);

}  // namespace bess
