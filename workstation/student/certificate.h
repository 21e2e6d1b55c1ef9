// What the prover found out about an integer student over the lattice, and against which thresholds
// [SPEC 6]. Anybody can write these numbers down: only a ProvedStudent (prove.h) is more than a claim.
#pragma once

#include <cstdint>
#include <vector>

#include "shared/features.h"
#include "shared/price_thresholds.h"
#include "workstation/student/rule_proof.h"

namespace bess {

struct Certificate {
  PriceThresholds thresholds = {};    ///< of properties 1 and 2
  std::int64_t states_checked = 0;    ///< 0: nobody has looked yet
  std::int64_t states_evaluated = 0;  ///< by the net itself; the rest is covered by bounds
  std::int64_t violations_property_1 = 0;
  std::int64_t violations_property_2 = 0;
  std::int64_t violations_property_3 = 0;
  std::vector<LatticeState> counterexamples = {};  ///< evenly thinned; not kept in files
  double seconds = 0;                              ///< not kept in files
  RuleSet rules = {};                              ///< the operator's, besides the properties
  std::vector<RuleCount> rule_counts = {};         ///< of each rule; empty: nobody has looked yet

  [[nodiscard]] std::int64_t violations() const {
    std::int64_t sum = violations_property_1 + violations_property_2 + violations_property_3;
    for (const RuleCount& count : rule_counts) sum += count.violations;
    return sum;
  }
  /// Every lattice state was checked and none violates a property.
  [[nodiscard]] bool covers_lattice_without_violation() const {
    return states_checked == kLatticeStateCount && rule_counts.size() == rules.rules.size() &&
           violations() == 0;
  }
};

}  // namespace bess
