// What the prover found out about an integer student over the lattice, and against which thresholds
// [SPEC 6]. Anybody can write these numbers down: only a ProvedStudent (prove.h) is more than a
// claim.
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
  std::int64_t states_checked = 0;    ///< 0: nobody has looked yet
  std::int64_t states_evaluated = 0;  ///< by the net itself; the rest is covered by bounds
  RuleSet rules = {};                 ///< the operator's, besides the properties
  /// Of each of demands(); shorter: nobody has counted the rest, and none of the operator's is
  /// known to hold. A file tells the violations of property 3 as one number, which then stands with
  /// the first of its rules.
  std::vector<RuleCount> counts = {};
  std::vector<LatticeState> counterexamples = {};  ///< evenly thinned; not kept in files
  double seconds = 0;                              ///< not kept in files

  /// The four built-in rules, then the operator's.
  [[nodiscard]] RuleSet demands() const { return with_built_in(thresholds, rules); }
  /// Of the operator's rules.
  [[nodiscard]] std::span<const RuleCount> rule_counts() const {
    if (counts.size() <= kBuiltInRuleCount) return {};
    return std::span(counts).subspan(kBuiltInRuleCount);
  }
  [[nodiscard]] std::int64_t violations() const;
  /// Of property 1 to 3.
  [[nodiscard]] std::int64_t violations_of(int property) const;
  void set_violations_of(int property, std::int64_t violations);
  /// Every lattice state was checked and none violates a property.
  [[nodiscard]] bool covers_lattice_without_violation() const;
};

// What a proof counted, as one list: the three properties and then the operator's rules, each by
// its name. Whatever tells of a proof, in lines, tables, JSON or CSV, goes through it.

struct DemandCount {
  std::string name;           ///< "property 1", or the rule's
  std::string text;           ///< what it asks, for people
  bool is_rule = false;       ///< else a property
  bool binds_student = true;  ///< false: the guard's alone, nothing was counted
  std::int64_t states = 0;    ///< states, or pairs of neighbours, that it was held against
  std::int64_t violations = 0;
  std::vector<Rule> rules = {};  ///< that it stands for: of property 3 two

  /// "property 1", or "rule \"quiet hours\"".
  [[nodiscard]] std::string label() const;
};

/// The properties, and all rules; of rules that nobody has looked at the counts are 0 and none
/// binds.
std::vector<DemandCount> demand_counts(const Certificate& certificate);

/// "property 3: 12, rule \"quiet hours\": 23994": what is broken; empty when nothing is.
std::string broken_text(const std::vector<DemandCount>& counts);

}  // namespace bess
