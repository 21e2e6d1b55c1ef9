// A policy that obeys rules: what it would decide, moved to the nearest action that is left. On the
// lattice that is the nearest of all policies that obey the rules and keep their directions, where
// the policy has the directions itself, as every proved student has; what is the guard's alone is
// cut as the guard cuts it. It tells what rules cost before anything is trained. A direction of
// another input than price and SoC is no demand on single states: it is not projected.
#pragma once

#include <memory>

#include "workstation/base/random.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/data/env/policy.h"

namespace bess {

// Counts, while a policy runs, how often it breaks each rule: in the states that it visits and, at
// each of them, at some other SoCs drawn at random. For policies whose states cannot all be looked
// at, float teachers first; and for how much of what really happens a violation touches.

/// Of one rule: looked at and broken, in visited states and in those drawn beside them. A direction
/// with price or SoC is looked at as a pair with the next price or SoC of the lattice; other
/// demands than that and actions cannot be seen in single states, and stay 0.
struct WatchCount {
  std::int64_t visited = 0;
  std::int64_t visited_broken = 0;
  std::int64_t drawn = 0;
  std::int64_t drawn_broken = 0;
};

class RuleWatch final : public Policy {
 public:
  RuleWatch(std::shared_ptr<Policy> policy, const RuleSet& rules, const ContextClasses& classes,
            int drawn_per_step, std::uint64_t seed);

  void begin(std::span<const MarketStep> ahead, double soc_frac) override {
    policy_->begin(ahead, soc_frac);
  }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

  [[nodiscard]] const std::vector<WatchCount>& counts() const { return counts_; }
  [[nodiscard]] std::int64_t decisions() const { return decisions_; }

 private:
  /// Whether the rule can be looked at here, and whether `action` breaks it.
  struct Look {
    bool applies, breaks;
  };
  [[nodiscard]] Look look(const Rule& rule, Action action, const MarketStep& step,
                          std::size_t index, double soc_frac) const;

  std::shared_ptr<Policy> policy_;
  RuleSet rules_;
  ContextClasses classes_;
  int drawn_per_step_;
  mutable Random random_;
  mutable std::vector<WatchCount> counts_;
  mutable std::int64_t decisions_ = 0;
};

/// Whether the rule is projected by a RuledPolicy at all.
bool can_be_projected(const Rule& rule);
/// Those of them that can be.
RuleSet projected_rules(const RuleSet& rules);

class RuledPolicy final : public Policy {
 public:
  /// `classes`: what the context classes of the rules mean. The rules must be consistent.
  RuledPolicy(std::shared_ptr<Policy> policy, const RuleSet& rules, const ContextClasses& classes);

  void begin(std::span<const MarketStep> ahead, double soc_frac) override {
    policy_->begin(ahead, soc_frac);
  }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;
  [[nodiscard]] double power_share_max(const MarketStep& step, double soc_frac) const override;

  /// Of all decisions so far, the share that the rules changed.
  [[nodiscard]] double changed_share() const {
    return decisions_ == 0 ? 0 : static_cast<double>(changed_) / static_cast<double>(decisions_);
  }

 private:
  std::shared_ptr<Policy> policy_;
  ContextClasses classes_;
  ImpliedRanges implied_;
  std::vector<GuardRule> guard_rules_;
  mutable std::int64_t decisions_ = 0;
  mutable std::int64_t changed_ = 0;
};

/// Where a step is looked up, as the edge would.
RulePoint rule_point_of(const MarketStep& step, double soc_frac, const ContextClasses& classes);

}  // namespace bess
