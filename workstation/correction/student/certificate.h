// Certificate: result of the prover for an integer student over the lattice, with its thresholds
// [SPEC 6]. These numbers alone prove nothing; only a ProvedStudent (prove.h) does.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shared/features.h"
#include "shared/nn/student_net.h"
#include "shared/price_thresholds.h"
#include "workstation/correction/rules/rule.h"

namespace bess {

// Proof of rules, built-in and operator's: each is a predicate over the lattice, counted by name on
// the action grids that verify_student() fills.
//   actions    states of the box whose action is not allowed
//   direction  pairs of neighbours along the input between which the action moves the wrong way

/// Result for one rule.
struct RuleCount {
  bool binds_student = false;  ///< false: guard only, not counted
  std::int64_t states = 0;     ///< checked lattice states, pairs or rows
  std::int64_t violations = 0;
  /// Some of them; those of the built-in rules are all with the first of these. Not kept in files.
  std::vector<LatticeState> counterexamples = {};

  void add(const RuleCount& other);
};

/// Actions of one context, [SoC][price].
using ActionGrid = std::vector<std::int8_t>;

/// Counts one context after another. One checker per thread.
class RuleChecker {
 public:
  /// Keeps a reference: `rules` must outlive it.
  RuleChecker(const RuleSet& rules, ContextKind kind);

  /// Neighbouring contexts, by input, whose grids check() needs: the next minute, quarter-hour or
  /// class.
  [[nodiscard]] const std::vector<RuleInput>& neighbours_needed() const { return neighbours_; }

  /// `neighbour`: grid of each needed input, in order; empty if there is none.
  void check(const LatticeState& context, const ActionGrid& grid,
             const std::vector<ActionGrid>& neighbours);

  [[nodiscard]] const std::vector<RuleCount>& counts() const { return counts_; }

 private:
  void check_row(std::size_t rule, int soc, const ActionGrid& grid,
                 const std::vector<ActionGrid>& neighbours);
  /// The row that a direction compares with this one; null if there is none.
  [[nodiscard]] const std::int8_t* next_row(RuleInput input, int soc, const ActionGrid& grid,
                                            const std::vector<ActionGrid>& neighbours) const;
  void keep(std::size_t rule, int soc, int price);

  const RuleSet& rules_;
  ContextKind kind_;
  std::vector<LatticeBox> boxes_;  ///< of each rule that binds the student
  std::vector<RuleInput> neighbours_;
  std::vector<RuleCount> counts_;
  LatticeState context_{};
  std::vector<std::size_t> holding_;  ///< rules that apply in this context
  std::vector<int> broken_;           ///< prices of the current row
  std::vector<int> kept_;             ///< counterexamples of this context by rule
};

/// The neighbour along an input; none after its last value.
std::optional<LatticeState> next_state(LatticeState state, RuleInput input);

/// The violated state with the largest lead, in logits, of the student's action over the best
/// allowed one, among the counterexamples and the corners of the box (the worst states of a
/// monotone student). None for demands other than actions.
struct WorstState {
  LatticeState state;
  Action action;
  std::int64_t lead;  ///< in units of the student's logits
};
std::optional<WorstState> worst_state(const StudentNet& net, const Rule& rule,
                                      const RuleCount& count);

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

// Verification: the integer student's action on ALL 6,950,033,280 lattice states [SPEC 6].
//
// For each of the 17,280 contexts (T_qh, qh, mo) the action grid over SoC x price is filled, then
// checked against every rule (RuleChecker), four of them built in (rules/rule.h):
//   property 1   states with price <= low whose action is not charge
//   property 2   states with price >= high whose action is not discharge
//   property 3   neighbour pairs (price + 1, or SoC + 1) where the action increases; the order of
//                comparable states follows from neighbours, so no pair violates it if and only
//                if no states do
// Filling is exhaustive or by sound bounds. Interval arithmetic through the net's integers, whose
// operations are all monotone, shows that a box of states has one action; an undecided box is
// halved, down to states that the edge's own code evaluates. Both methods give the same counts.

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
