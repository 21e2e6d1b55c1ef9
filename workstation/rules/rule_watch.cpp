#include "workstation/rules/rule_watch.h"

#include "workstation/rules/ruled_policy.h"

namespace bess {

RuleWatch::RuleWatch(std::shared_ptr<Policy> policy, const RuleSet& rules,
                     const ContextClasses& classes, int drawn_per_step, std::uint64_t seed)
    : policy_(std::move(policy)),
      rules_(rules),
      classes_(classes),
      drawn_per_step_(drawn_per_step),
      random_(seed),
      counts_(rules.rules.size()) {}

RuleWatch::Look RuleWatch::look(const Rule& rule, Action action, const MarketStep& step,
                                std::size_t index, double soc_frac) const {
  const Demand& demand = *rule.demand;
  if (!demand.binds_student()) return {false, false};
  const std::optional<RuleInput> along = demand.pairs_along();
  if (!along) {
    return {rule.box.contains(rule_point_of(step, soc_frac, classes_)),
            demand.is_broken(action, action)};
  }
  MarketStep next = step;
  double next_soc_frac = soc_frac;
  if (along == RuleInput::kPrice) {
    next.observed_eur_per_mwh += 1;
  } else if (along == RuleInput::kSoc) {
    next_soc_frac += 1.0 / (kSocCount - 1);
  } else {
    return {false, false};
  }
  const Action after = policy_->decide(next, index, next_soc_frac);
  return {next_soc_frac <= 1, demand.is_broken(action, after)};
}

Action RuleWatch::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  const Action action = policy_->decide(step, index, soc_frac);
  ++decisions_;
  for (std::size_t r = 0; r < counts_.size(); ++r) {
    const Look found = look(rules_.rules[r], action, step, index, soc_frac);
    if (!found.applies) continue;
    ++counts_[r].visited;
    counts_[r].visited_broken += found.breaks ? 1 : 0;
  }
  for (int n = 0; n < drawn_per_step_; ++n) {
    const double drawn_soc_frac = random_.uniform();
    const Action drawn = policy_->decide(step, index, drawn_soc_frac);
    for (std::size_t r = 0; r < counts_.size(); ++r) {
      const Look found = look(rules_.rules[r], drawn, step, index, drawn_soc_frac);
      if (!found.applies) continue;
      ++counts_[r].drawn;
      counts_[r].drawn_broken += found.breaks ? 1 : 0;
    }
  }
  return action;
}

}  // namespace bess
