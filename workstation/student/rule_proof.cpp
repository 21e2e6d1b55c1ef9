#include "workstation/student/rule_proof.h"

#include <algorithm>
#include <limits>

#include "workstation/student/verify.h"

namespace bess {
namespace {

constexpr int kKeptPerContext = 4;
constexpr std::size_t kKeptPerRule = 4096;

/// Adds violations up, and keeps the first few states of each context.
class Tally {
 public:
  Tally(const LatticeState& context, RuleCount& count) : context_(context), count_(count) {}

  /// Cells [begin, end) of a row of the grid, of which `violates(cell)` tells.
  template <typename Violates>
  void add_row(int soc, int begin, int end, Violates violates) {
    count_.states += std::max(0, end - begin);
    std::int8_t any = 0;  // as wide as an action, branch-free: vectorises
    for (int p = begin; p < end; ++p) any |= static_cast<std::int8_t>(violates(p));
    if (any == 0) return;
    for (int p = begin; p < end; ++p) {
      if (violates(p)) add(soc, p);
    }
  }
  void add(int soc, int price) {
    ++count_.violations;
    if (kept_ == kKeptPerContext || count_.counterexamples.size() >= kKeptPerRule) return;
    ++kept_;
    LatticeState state = context_;
    state.soc_index = static_cast<std::int16_t>(soc);
    state.price_eur_per_mwh = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + price);
    count_.counterexamples.push_back(state);
  }

 private:
  const LatticeState& context_;
  RuleCount& count_;
  int kept_ = 0;
};

const std::int8_t* row_of(const ActionGrid& grid, int soc) {
  return &grid[static_cast<std::size_t>(soc) * kPriceCount];
}

}  // namespace

void RuleCount::add(const RuleCount& other) {
  binds_student = other.binds_student;
  states += other.states;
  violations += other.violations;
  counterexamples.insert(counterexamples.end(), other.counterexamples.begin(),
                         other.counterexamples.end());
}

std::optional<LatticeState> next_context(LatticeState context, RuleInput input) {
  switch (input) {
    case RuleInput::kMinute:
      if (++context.minute_of_quarter_hour == kMinuteOfQuarterHourCount) return {};
      return context;
    case RuleInput::kQuarterHour:
      if (++context.quarter_hour == kQuarterHourCount) return {};
      return context;
    case RuleInput::kContextClass:
      if (++context.context_class > kContextClassCount) return {};
      return context;
    case RuleInput::kSoc:
    case RuleInput::kPrice:
      break;
  }
  return {};
}

RuleChecker::RuleChecker(const RuleSet& rules, ContextKind kind)
    : rules_(rules), kind_(kind), counts_(rules.rules.size()) {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const Rule& rule = rules.rules[i];
    counts_[i].binds_student = binds_student(rule, kind);
    const RuleInput input = rule.direction.input;
    const bool is_in_grid = input == RuleInput::kSoc || input == RuleInput::kPrice;
    if (rule.demand != Demand::kDirection || is_in_grid) continue;
    if (std::ranges::find(neighbours_, input) == neighbours_.end()) neighbours_.push_back(input);
  }
}

void RuleChecker::check(const LatticeState& context, const ActionGrid& grid,
                        const std::vector<ActionGrid>& neighbours) {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const Rule& rule = rules_.rules[i];
    if (!counts_[i].binds_student ||
        !holds_in_context(rule.box, kind_, context.quarter_hour, context.context_class)) {
      continue;
    }
    switch (rule.demand) {
      case Demand::kActions:
        check_actions(rule, context, grid, counts_[i]);
        break;
      case Demand::kDirection:
        check_direction(rule, context, grid, neighbours, counts_[i]);
        break;
      case Demand::kPower:
        break;
    }
  }
}

void RuleChecker::check_actions(const Rule& rule, const LatticeState& context,
                                const ActionGrid& grid, RuleCount& count) const {
  const LatticeBox box = lattice_box_of(rule.box, kind_);
  const auto lowest = static_cast<std::int8_t>(rule.lowest());
  const auto highest = static_cast<std::int8_t>(rule.highest());
  constexpr auto kIdle = static_cast<std::int8_t>(Action::kIdle);
  const std::int8_t forbidden = rule.has_gap() ? kIdle : std::int8_t{-1};
  Tally tally(context, count);
  for (int s = box.soc_first; s <= box.soc_last; ++s) {
    const std::int8_t* row = row_of(grid, s);
    tally.add_row(s, box.price_first, box.price_last + 1, [&](int p) {
      return (row[p] < lowest) | (row[p] > highest) | (row[p] == forbidden);
    });
  }
}

void RuleChecker::check_direction(const Rule& rule, const LatticeState& context,
                                  const ActionGrid& grid, const std::vector<ActionGrid>& neighbours,
                                  RuleCount& count) const {
  Tally tally(context, count);
  const auto count_pairs = [&](int soc, int pairs, const std::int8_t* row,
                               const std::int8_t* next) {
    if (rule.direction.sign < 0) {
      tally.add_row(soc, 0, pairs, [&](int p) { return next[p] > row[p]; });
    } else {
      tally.add_row(soc, 0, pairs, [&](int p) { return next[p] < row[p]; });
    }
  };
  if (rule.direction.input == RuleInput::kPrice) {
    for (int s = 0; s < kSocCount; ++s) {
      count_pairs(s, kPriceCount - 1, row_of(grid, s), row_of(grid, s) + 1);
    }
    return;
  }
  if (rule.direction.input == RuleInput::kSoc) {
    for (int s = 0; s + 1 < kSocCount; ++s) {
      count_pairs(s, kPriceCount, row_of(grid, s), row_of(grid, s + 1));
    }
    return;
  }
  const auto which = std::ranges::find(neighbours_, rule.direction.input) - neighbours_.begin();
  const ActionGrid& next = neighbours[static_cast<std::size_t>(which)];
  if (next.empty()) return;
  for (int s = 0; s < kSocCount; ++s) {
    count_pairs(s, kPriceCount, row_of(grid, s), row_of(next, s));
  }
}

std::optional<WorstState> worst_state(const StudentNet& net, const Rule& rule,
                                      const RuleCount& count) {
  if (rule.demand != Demand::kActions) return {};
  std::optional<WorstState> worst;
  const LatticeBox box = lattice_box_of(rule.box, net.context.kind);
  const auto look = [&](const LatticeState& state) {
    std::int16_t x[kStudentInputs];
    std::int32_t logits[kActionCount];
    net.quantise(state, x);
    net.propagate(x, logits);
    const Action action = argmax_action(logits);
    if (allows(rule.actions, action)) return;
    std::int64_t best = std::numeric_limits<std::int64_t>::min();
    for (int a = 0; a < kActionCount; ++a) {
      if (allows(rule.actions, static_cast<Action>(a)))
        best = std::max<std::int64_t>(best, logits[a]);
    }
    const std::int64_t lead = logits[static_cast<int>(action)] - best;
    if (!worst || lead > worst->lead) worst = WorstState{state, action, lead};
  };
  for (const LatticeState& state : count.counterexamples) look(state);
  for (int c = 0; c < kContextCount; ++c) {
    LatticeState state = context_at(c);
    if (!holds_in_context(rule.box, net.context.kind, state.quarter_hour, state.context_class)) {
      continue;
    }
    for (const auto& [soc, price] :
         {std::pair{box.soc_first, box.price_first}, std::pair{box.soc_last, box.price_last}}) {
      state.soc_index = static_cast<std::int16_t>(soc);
      state.price_eur_per_mwh = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + price);
      look(state);
    }
  }
  return worst;
}

}  // namespace bess
