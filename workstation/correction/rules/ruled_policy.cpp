#include "workstation/correction/rules/ruled_policy.h"

#include <algorithm>
#include <cmath>

namespace bess {

RuleWatch::RuleWatch(std::shared_ptr<Policy> policy, const RuleSet& rules,
                     const ContextClasses& classes, int drawn_per_step, std::uint64_t seed)
    : policy_(std::move(policy)),
      rules_(rules),
      classes_(classes),
      drawn_per_step_(drawn_per_step),
      random_(seed),
      counts_(rules.rules.size()) {}

std::optional<bool> RuleWatch::is_broken(const Rule& rule, Action action, const MarketStep& step,
                                         std::size_t index, double soc_frac) const {
  const Demand& demand = *rule.demand;
  if (!demand.binds_student()) return {};
  const std::optional<RuleInput> along = demand.pairs_along();
  if (!along) {
    if (!rule.box.contains(rule_point_of(step, soc_frac, classes_))) return {};
    return demand.is_broken(action, action);
  }
  MarketStep next = step;
  double next_soc_frac = soc_frac;
  if (along == RuleInput::kPrice) {
    next.observed_eur_per_mwh += 1;
  } else if (along == RuleInput::kSoc) {
    next_soc_frac += 1.0 / (kSocCount - 1);
  } else {
    return {};
  }
  const Action after = policy_->decide(next, index, next_soc_frac);
  if (next_soc_frac > 1) return {};
  return demand.is_broken(action, after);
}

Action RuleWatch::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  const Action action = policy_->decide(step, index, soc_frac);
  ++decisions_;
  const auto count = [&](Action decided, double at_soc_frac, std::int64_t WatchCount::*checked,
                         std::int64_t WatchCount::*violated) {
    for (std::size_t r = 0; r < counts_.size(); ++r) {
      const auto broken = is_broken(rules_.rules[r], decided, step, index, at_soc_frac);
      if (!broken) continue;
      ++(counts_[r].*checked);
      counts_[r].*violated += *broken ? 1 : 0;
    }
  };
  count(action, soc_frac, &WatchCount::visited, &WatchCount::visited_broken);
  for (int n = 0; n < drawn_per_step_; ++n) {
    const double drawn_soc_frac = random_.uniform();
    count(policy_->decide(step, index, drawn_soc_frac), drawn_soc_frac, &WatchCount::drawn,
          &WatchCount::drawn_broken);
  }
  return action;
}

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

Action RuledPolicy::decide(const MarketStep& step, std::size_t index, double soc_frac) const {
  const RulePoint point = rule_point_of(step, soc_frac, classes_);
  const Action wanted = policy_->decide(step, index, soc_frac);
  const int price =
      std::clamp(point.price_eur_per_mwh, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
  const ActionSet allowed =
      implied_.at(point.quarter_hour, point.context_class, point.soc_index, price);
  const Action action =
      nearest_allowed(limits_at(step, soc_frac).actions, nearest_allowed(allowed, wanted));
  ++decisions_;
  changed_ += action != wanted ? 1 : 0;
  return action;
}

}  // namespace bess
