#include "workstation/student/rule_proof.h"

#include <algorithm>
#include <limits>

#include "workstation/student/verify.h"

namespace bess {
namespace {

constexpr int kKeptPerContext = 4;
constexpr int kKeptOfPropertiesPerContext = 16;  ///< of the four together
constexpr std::size_t kKeptPerRule = 4096;

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
    : rules_(rules),
      kind_(kind),
      boxes_(rules.rules.size()),
      counts_(rules.rules.size()),
      kept_(rules.rules.size()) {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const Rule& rule = rules.rules[i];
    counts_[i].binds_student = binds_student(rule, kind);
    if (counts_[i].binds_student) boxes_[i] = lattice_box_of(rule.box, kind);
    const RuleInput input = rule.direction.input;
    const bool is_in_grid = input == RuleInput::kSoc || input == RuleInput::kPrice;
    if (rule.demand != Demand::kDirection || is_in_grid) continue;
    if (std::ranges::find(neighbours_, input) == neighbours_.end()) neighbours_.push_back(input);
  }
}

void RuleChecker::check(const LatticeState& context, const ActionGrid& grid,
                        const std::vector<ActionGrid>& neighbours) {
  context_ = context;
  std::ranges::fill(kept_, 0);
  holding_.clear();
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i].binds_student &&
        holds_in_context(rules_.rules[i].box, kind_, context.quarter_hour, context.context_class)) {
      holding_.push_back(i);
    }
  }
  for (int s = 0; s < kSocCount;
       ++s) {  // outside: a row is held against every rule while it is near
    for (const std::size_t rule : holding_) check_row(rule, s, grid, neighbours);
  }
}

void RuleChecker::check_row(std::size_t index, int soc, const ActionGrid& grid,
                            const std::vector<ActionGrid>& neighbours) {
  const Rule& rule = rules_.rules[index];
  const std::int8_t* row = row_of(grid, soc);
  if (rule.demand == Demand::kActions) {
    const LatticeBox& box = boxes_[index];
    if (soc < box.soc_first || soc > box.soc_last) return;
    const auto lowest = static_cast<std::int8_t>(rule.lowest());
    const auto highest = static_cast<std::int8_t>(rule.highest());
    constexpr auto kIdle = static_cast<std::int8_t>(Action::kIdle);
    const std::int8_t forbidden = rule.has_gap() ? kIdle : std::int8_t{-1};
    count_row(index, soc, box.price_first, box.price_last + 1, [=](int p) {
      return (row[p] < lowest) | (row[p] > highest) | (row[p] == forbidden);
    });
  } else if (const std::int8_t* next = next_row(rule.direction.input, soc, grid, neighbours)) {
    const int pairs = rule.direction.input == RuleInput::kPrice ? kPriceCount - 1 : kPriceCount;
    if (rule.direction.sign < 0) {
      count_row(index, soc, 0, pairs, [=](int p) { return next[p] > row[p]; });
    } else {
      count_row(index, soc, 0, pairs, [=](int p) { return next[p] < row[p]; });
    }
  }
}

const std::int8_t* RuleChecker::next_row(RuleInput input, int soc, const ActionGrid& grid,
                                         const std::vector<ActionGrid>& neighbours) const {
  if (input == RuleInput::kPrice) return row_of(grid, soc) + 1;
  if (input == RuleInput::kSoc) return soc + 1 < kSocCount ? row_of(grid, soc + 1) : nullptr;
  const auto which = std::ranges::find(neighbours_, input) - neighbours_.begin();
  const ActionGrid& next = neighbours[static_cast<std::size_t>(which)];
  return next.empty() ? nullptr : row_of(next, soc);
}

/// Cells [begin, end) of a row, of which `violates(cell)` tells.
template <typename Violates>
void RuleChecker::count_row(std::size_t rule, int soc, int begin, int end, Violates violates) {
  RuleCount& count = counts_[rule];
  count.states += std::max(0, end - begin);
  std::int8_t any = 0;  // as wide as an action, branch-free: vectorises
  for (int p = begin; p < end; ++p) any |= static_cast<std::int8_t>(violates(p));
  if (any == 0) return;
  for (int p = begin; p < end; ++p) {
    if (!violates(p)) continue;
    ++count.violations;
    keep(rule, soc, p);
  }
}

/// The first few of each context, those of the built-in rules as they come along.
void RuleChecker::keep(std::size_t rule, int soc, int price) {
  const bool is_built_in = rules_.rules[rule].property != 0;
  const std::size_t with = is_built_in ? 0 : rule;
  std::vector<LatticeState>& states = counts_[with].counterexamples;
  if (kept_[with] == (is_built_in ? kKeptOfPropertiesPerContext : kKeptPerContext)) return;
  if (!is_built_in && states.size() >= kKeptPerRule) return;
  ++kept_[with];
  LatticeState state = context_;
  state.soc_index = static_cast<std::int16_t>(soc);
  state.price_eur_per_mwh = static_cast<std::int16_t>(kLatticePriceMinEurPerMwh + price);
  states.push_back(state);
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
