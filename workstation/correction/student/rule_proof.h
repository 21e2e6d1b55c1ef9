// The proof of rules, the built-in ones and an operator's: each a predicate over the lattice,
// counted by name on the action grids that verify.h fills.
//   actions    states of the box whose action is not allowed
//   direction  pairs of neighbours along the input between which the action moves the wrong way
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "shared/nn/student_net.h"
#include "workstation/correction/rules/rule.h"

namespace bess {

/// What was found about one rule.
struct RuleCount {
  bool binds_student = false;  ///< false: the guard's alone, nothing was counted
  std::int64_t states = 0;     ///< lattice states, or pairs or rows, that it was held against
  std::int64_t violations = 0;
  /// Some of them; those of the built-in rules all stand with the first of these. Not kept in
  /// files.
  std::vector<LatticeState> counterexamples = {};

  void add(const RuleCount& other);
};

/// Actions of one context, [SoC][price].
using ActionGrid = std::vector<std::int8_t>;

/// Counts one context after another. One checker a thread.
class RuleChecker {
 public:
  /// Keeps a reference: `rules` must outlive it.
  RuleChecker(const RuleSet& rules, ContextKind kind);

  /// Contexts beside this one, by input, whose grids check() needs: the next minute, quarter-hour
  /// or class.
  [[nodiscard]] const std::vector<RuleInput>& neighbours_needed() const { return neighbours_; }

  /// `neighbour` of each input that is needed, in order; empty where there is none.
  void check(const LatticeState& context, const ActionGrid& grid,
             const std::vector<ActionGrid>& neighbours);

  [[nodiscard]] const std::vector<RuleCount>& counts() const { return counts_; }

 private:
  void check_row(std::size_t rule, int soc, const ActionGrid& grid,
                 const std::vector<ActionGrid>& neighbours);
  /// The row that a direction compares with this one; null where there is none.
  [[nodiscard]] const std::int8_t* next_row(RuleInput input, int soc, const ActionGrid& grid,
                                            const std::vector<ActionGrid>& neighbours) const;
  void keep(std::size_t rule, int soc, int price);

  const RuleSet& rules_;
  ContextKind kind_;
  std::vector<LatticeBox> boxes_;  ///< of each rule that binds the student
  std::vector<RuleInput> neighbours_;
  std::vector<RuleCount> counts_;
  LatticeState context_{};
  std::vector<std::size_t> holding_;  ///< rules that hold in this context
  std::vector<int> broken_;           ///< prices of the row that is looked at
  std::vector<int> kept_;             ///< counterexamples of this context, of each rule
};

/// The context after this one along an input; none after its last value.
std::optional<LatticeState> next_context(LatticeState context, RuleInput input);

/// The violated state that the student is surest of, by the lead in logits of what it does over the
/// best that is allowed: of the counterexamples and of the box's corners, where a monotone student
/// is worst. None for other demands than actions.
struct WorstState {
  LatticeState state;
  Action action;
  std::int64_t lead;  ///< in units of the student's logits
};
std::optional<WorstState> worst_state(const StudentNet& net, const Rule& rule,
                                      const RuleCount& count);

}  // namespace bess
