// Verification: the integer student's action on ALL 6,950,033,280 lattice states [SPEC 6].
//
// For each of the 17,280 contexts (T_qh, qh, mo) the action grid over SoC x price is filled, then
// checked against every rule (certificate.h), four of them built in (rules/rule.h):
//   property 1   states with price <= low whose action is not charge
//   property 2   states with price >= high whose action is not discharge
//   property 3   neighbour pairs (price + 1, or SoC + 1) where the action increases; the order of
//                comparable states follows from neighbours, so no pair violates it if and only
//                if no states do
// Filling is exhaustive or by sound bounds. Interval arithmetic through the net's integers, whose
// operations are all monotone, shows that a box of states has one action; an undecided box is
// halved, down to states that the edge's own code evaluates. Both methods give the same counts.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/nn/student_net.h"
#include "workstation/correction/student/certificate.h"

namespace bess {

struct VerifyOptions {
  PriceThresholds thresholds = {};
  RuleSet rules = {};       ///< operator's rules
  bool exhaustive = false;  ///< evaluate every state, no bounds
  int context_stride = 1;   ///< check every n-th context only (a quick look, not a proof)
  std::size_t counterexamples_max = 4096;
  int threads = 2;
};

/// Counts every demand on the whole lattice, or on every `context_stride`-th context. check_net()
/// must accept the net; threads >= 1. The counts do not depend on the threads.
Certificate verify_student(const StudentNet& net, const VerifyOptions& options);

/// Context `index` of kContextCount, with SoC and price 0.
LatticeState context_at(int index);

/// Actions of one context, [SoC][price], as Action's integers. Returns the number of evaluated
/// states.
std::int64_t fill_action_grid(const StudentNet& net, const LatticeState& context, bool exhaustive,
                              std::vector<std::int8_t>& grid);

}  // namespace bess
