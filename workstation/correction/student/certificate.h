// Certificate: result of the prover for an integer student over the lattice, with its thresholds
// [SPEC 6]. These numbers alone prove nothing; only a ProvedStudent (prove.h) does.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "shared/features.h"
#include "shared/price_thresholds.h"
#include "workstation/correction/rules/properties.h"
#include "workstation/correction/student/rule_proof.h"

namespace bess {

struct Certificate {
  PriceThresholds thresholds = {};    ///< of properties 1 and 2
  std::int64_t states_checked = 0;    ///< 0: not checked yet
  std::int64_t states_evaluated = 0;  ///< by the net; bounds cover the rest
  RuleSet rules = {};                 ///< operator's rules
  /// One for each of demands(). If shorter, the rest is not counted, and no operator's rule is
  /// known to be satisfied. A file has one number for property 3; it is stored with the first of
  /// its rules.
  std::vector<RuleCount> counts = {};
  std::vector<LatticeState> counterexamples = {};  ///< evenly thinned; not kept in files
  double seconds = 0;                              ///< not kept in files

  /// The four built-in rules, then the operator's.
  [[nodiscard]] RuleSet demands() const { return with_built_in(thresholds, rules); }
  /// Counts of the operator's rules.
  [[nodiscard]] std::span<const RuleCount> rule_counts() const {
    if (counts.size() <= kBuiltInRuleCount) return {};
    return std::span(counts).subspan(kBuiltInRuleCount);
  }
  [[nodiscard]] std::int64_t violations() const;
  /// `property` is 1 to 3.
  [[nodiscard]] std::int64_t violations_of(int property) const;
  void set_violations_of(int property, std::int64_t violations);
  /// Every lattice state was checked and none violates a property.
  [[nodiscard]] bool covers_lattice_without_violation() const;
};

// Counts of a proof as one list: the three properties, then the operator's rules by name. All
// outputs (text, tables, JSON, CSV) use it.

struct DemandCount {
  std::string name;           ///< "property 1", or the rule's
  std::string text;           ///< readable form of the demand
  bool is_rule = false;       ///< else a property
  bool binds_student = true;  ///< false: guard only, not counted
  std::int64_t states = 0;    ///< properties: all checked states; rules: states or pairs of the box
  std::int64_t violations = 0;
  std::vector<Rule> rules = {};  ///< its rules; property 3 has two

  /// "property 1", or "rule \"quiet hours\"".
  [[nodiscard]] std::string label() const;
};

/// Properties and all rules; rules that were not checked have count 0 and do not bind.
std::vector<DemandCount> demand_counts(const Certificate& certificate);

}  // namespace bess
