#include "workstation/correction/student/certificate.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

namespace bess {

std::string DemandCount::label() const { return is_rule ? fmt::format("rule \"{}\"", name) : name; }

std::vector<DemandCount> demand_counts(const Certificate& c) {
  std::vector<DemandCount> counts;
  const RuleSet demands = c.demands();
  for (std::size_t d = 0; d < demands.rules.size(); ++d) {
    const Rule& rule = demands.rules[d];
    const RuleCount found = d < c.counts.size() ? c.counts[d] : RuleCount{};
    if (rule.property == 0) {
      counts.push_back({rule.name,
                        rule.text(),
                        true,
                        found.binds_student,
                        found.states,
                        found.violations,
                        {rule}});
    } else if (static_cast<std::size_t>(rule.property) == counts.size()) {  // its second direction
      counts.back().violations += found.violations;
      counts.back().rules.push_back(rule);
    } else {
      const bool binds = overlaps_lattice(rule.box);
      counts.push_back({fmt::format("property {}", rule.property),
                        property_text(rule.property, c.thresholds),
                        false,
                        binds,
                        binds ? c.states_checked : 0,
                        found.violations,
                        {rule}});
    }
  }
  return counts;
}

std::int64_t Certificate::violations() const {
  std::int64_t sum = 0;
  for (const RuleCount& count : counts) sum += count.violations;
  return sum;
}

std::int64_t Certificate::violations_of(int property) const {
  const RuleSet built_in = built_in_rules(thresholds);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < std::min(counts.size(), kBuiltInRuleCount); ++i) {
    if (built_in.rules[i].property == property) sum += counts[i].violations;
  }
  return sum;
}

void Certificate::set_violations_of(int property, std::int64_t violations) {
  if (counts.size() < kBuiltInRuleCount) counts.resize(kBuiltInRuleCount);
  const RuleSet built_in = built_in_rules(thresholds);
  for (std::size_t i = 0; i < kBuiltInRuleCount; ++i) {
    if (built_in.rules[i].property != property) continue;
    counts[i].violations = violations;
    violations = 0;  // the first entry counts for all
  }
}

bool Certificate::covers_lattice_without_violation() const {
  return states_checked == kLatticeStateCount && rule_counts().size() == rules.rules.size() &&
         violations() == 0;
}

namespace {

constexpr int kKeptPerContext = 4;
constexpr int kKeptOfPropertiesPerContext = 16;  ///< all four together
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

std::optional<LatticeState> next_state(LatticeState state, RuleInput input) {
  struct Field {
    std::int16_t LatticeState::*value;
    int last;
  };
  constexpr Field kFields[kRuleInputCount] = {
      {&LatticeState::minute_of_quarter_hour, kMinuteOfQuarterHourCount - 1},
      {&LatticeState::quarter_hour, kQuarterHourCount - 1},
      {&LatticeState::context_class, kContextClassCount},
      {&LatticeState::soc_index, kSocCount - 1},
      {&LatticeState::price_eur_per_mwh, kLatticePriceMaxEurPerMwh}};
  const Field& field = kFields[static_cast<std::size_t>(input)];
  if (++(state.*field.value) > field.last) return {};
  return state;
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
    const std::optional<RuleInput> along = rule.demand->pairs_along();
    if (!along || along == RuleInput::kSoc || along == RuleInput::kPrice) continue;
    if (std::ranges::find(neighbours_, *along) == neighbours_.end()) neighbours_.push_back(*along);
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
  for (int s = 0; s < kSocCount; ++s) {  // outer loop: all rules check a row while it is cached
    for (const std::size_t rule : holding_) check_row(rule, s, grid, neighbours);
  }
}

void RuleChecker::check_row(std::size_t index, int soc, const ActionGrid& grid,
                            const std::vector<ActionGrid>& neighbours) {
  const LatticeBox& box = boxes_[index];
  if (soc < box.soc_first || soc > box.soc_last) return;
  const Demand& demand = *rules_.rules[index].demand;
  const std::optional<RuleInput> along = demand.pairs_along();
  const std::int8_t* here = row_of(grid, soc);
  const std::int8_t* neighbour = along ? next_row(*along, soc, grid, neighbours) : here;
  if (neighbour == nullptr) return;
  const int last = along == RuleInput::kPrice ? kPriceCount - 1 : kPriceCount;
  const int end = std::min(box.price_last + 1, last);
  RuleCount& count = counts_[index];
  count.states += std::max(0, end - box.price_first);
  broken_.clear();
  demand.broken({here, neighbour, box.price_first, end}, broken_);
  count.violations += static_cast<std::int64_t>(broken_.size());
  for (const int price : broken_) keep(index, soc, price);
}

const std::int8_t* RuleChecker::next_row(RuleInput input, int soc, const ActionGrid& grid,
                                         const std::vector<ActionGrid>& neighbours) const {
  if (input == RuleInput::kPrice) return row_of(grid, soc) + 1;
  if (input == RuleInput::kSoc) return soc + 1 < kSocCount ? row_of(grid, soc + 1) : nullptr;
  const auto which = std::ranges::find(neighbours_, input) - neighbours_.begin();
  const ActionGrid& next = neighbours[static_cast<std::size_t>(which)];
  return next.empty() ? nullptr : row_of(next, soc);
}

/// Keeps the first counterexamples of each context; those of the built-in rules share one limit.
void RuleChecker::keep(std::size_t rule, int soc, int price) {
  const bool is_built_in = rules_.rules[rule].property != 0;
  const std::size_t with = is_built_in ? 0 : rule;
  std::vector<LatticeState>& states = counts_[with].counterexamples;
  if (kept_[with] == (is_built_in ? kKeptOfPropertiesPerContext : kKeptPerContext)) return;
  if (!is_built_in && states.size() >= kKeptPerRule) return;
  ++kept_[with];
  states.push_back(at_indices(context_, soc, price));
}

std::optional<WorstState> worst_state(const StudentNet& net, const Rule& rule,
                                      const RuleCount& count) {
  if (rule.demand->pairs_along()) return {};
  std::optional<WorstState> worst;
  const LatticeBox box = lattice_box_of(rule.box, net.context.kind);
  const auto look = [&](const LatticeState& state) {
    std::int16_t x[kStudentInputs];
    std::int32_t logits[kActionCount];
    net.quantise(state, x);
    net.propagate(x, logits);
    const Action action = argmax_action(logits);
    if (allows(rule.actions(), action)) return;
    std::int64_t best = std::numeric_limits<std::int64_t>::min();
    for (int a = 0; a < kActionCount; ++a) {
      if (!allows(rule.actions(), static_cast<Action>(a))) continue;
      best = std::max<std::int64_t>(best, logits[a]);
    }
    const std::int64_t lead = logits[static_cast<int>(action)] - best;
    if (!worst || lead > worst->lead) worst = WorstState{state, action, lead};
  };
  for (const LatticeState& state : count.counterexamples) look(state);
  for (int c = 0; c < kContextCount; ++c) {
    const LatticeState context = context_at(c);
    if (!holds_in_context(rule.box, net.context.kind, context.quarter_hour,
                          context.context_class)) {
      continue;
    }
    look(at_indices(context, box.soc_first, box.price_first));
    look(at_indices(context, box.soc_last, box.price_last));
  }
  return worst;
}

}  // namespace bess
