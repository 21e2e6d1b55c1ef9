// The proof: the integer student's action on EVERY lattice state [SPEC 6], 6,950,033,280 of them.
//
// For each of the 17,280 contexts (T_qh, qh, mo) the action grid over SoC x price is filled, then
// held against every rule (rule_proof.h), of which four are built in (rules/properties.h):
//   property 1   states with price <= low whose action is not charge
//   property 2   states with price >= high whose action is not discharge
//   property 3   neighbour pairs (price + 1, or SoC + 1) where the action increases; the order of
//                any two comparable states follows from neighbours, so none violates if and only if
//                no pair does
// Filling is exhaustive, or by sound bounds: interval arithmetic through the very integers of the
// net, whose every operation is monotone, shows that a box of states has one action; a box it
// cannot decide is halved, down to states that are evaluated by the code that the edge runs. Both
// give the same counts.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/nn/student_net.h"
#include "workstation/correction/student/certificate.h"

namespace bess {

struct VerifyOptions {
  PriceThresholds thresholds = {};
  RuleSet rules = {};       ///< the operator's
  bool exhaustive = false;  ///< evaluate every state, no bounds
  int context_stride = 1;   ///< check every n-th context only (a quick look, not a proof)
  std::size_t counterexamples_max = 4096;
  int threads = 2;
};

Certificate verify_student(const StudentNet& net, const VerifyOptions& options);

/// Context `index` of kContextCount, with SoC and price 0.
LatticeState context_at(int index);

/// Actions of one context, [SoC][price], as Action's integers. Returns how many states were
/// evaluated.
std::int64_t fill_action_grid(const StudentNet& net, int minute_of_quarter_hour, int quarter_hour,
                              int context_class, bool exhaustive, std::vector<std::int8_t>& grid);

}  // namespace bess
