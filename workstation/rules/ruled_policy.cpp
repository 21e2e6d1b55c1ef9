#include "workstation/rules/ruled_policy.h"

#include <algorithm>
#include <cmath>

namespace bess {

bool can_be_projected(const Rule& rule) { return !rule.demand->pairs_along(); }

RuleSet projected_rules(const RuleSet& rules) {
  RuleSet projected;
  std::ranges::copy_if(rules.rules, std::back_inserter(projected.rules), can_be_projected);
  return projected;
}

RulePoint rule_point_of(const MarketStep& step, double soc_frac, const ContextClasses& classes) {
  const auto soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * kSocFullE4));
  return {.price_eur_per_mwh = whole_price_of(price_centi_of(step.observed_eur_per_mwh)),
          .soc_index = soc_index_of(soc_e4),
          .quarter_hour = step.quarter_hour,
          .month = step.month,
          .context_class = classes.class_of(step.month, step.level_centi_eur_per_mwh)};
}

RuledPolicy::RuledPolicy(std::shared_ptr<Policy> policy, const RuleSet& rules,
                         const ContextClasses& classes)
    : policy_(std::move(policy)),
      classes_(classes),
      implied_(rules, classes.kind),
      guard_rules_(rules.guard_rules()) {}

Action RuledPolicy::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  const RulePoint point = rule_point_of(step, soc_frac, classes_);
  const Action wanted = policy_->decide(step, index, soc_frac);
  const int price =
      std::clamp(point.price_eur_per_mwh, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
  const ActionRange range =
      implied_.at(point.quarter_hour, point.context_class, point.soc_index, price);
  const Action action = nearest_allowed(rule_limits_at(guard_rules_, point).actions,
                                        nearest_allowed(range.set(), wanted));
  ++decisions_;
  changed_ += action != wanted ? 1 : 0;
  return action;
}

double RuledPolicy::power_share_max(const MarketStep& step, double soc_frac) const {
  const RuleLimits limits = rule_limits_at(guard_rules_, rule_point_of(step, soc_frac, classes_));
  return limits.power_permille_max / double{kFullPowerPermille};
}

}  // namespace bess
