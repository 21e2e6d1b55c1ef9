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
  if (rule.demand == Demand::kActions) {
    return {rule.box.contains(rule_point_of(step, soc_frac, classes_)),
            !allows(rule.actions, action)};
  }
  if (rule.demand != Demand::kDirection) return {false, false};
  MarketStep next = step;
  double next_soc_frac = soc_frac;
  if (rule.direction.input == RuleInput::kPrice) {
    next.observed_eur_per_mwh += 1;
  } else if (rule.direction.input == RuleInput::kSoc) {
    next_soc_frac += 1.0 / (kSocCount - 1);
  } else {
    return {false, false};
  }
  const Action after = policy_->decide(next, index, next_soc_frac);
  return {next_soc_frac <= 1, rule.direction.sign < 0 ? after > action : after < action};
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
