// Policy under rules: replaces a policy's decision by the nearest allowed action. If the policy has
// the directions itself, as every proved student does, the result on the lattice is the nearest
// policy that satisfies the rules and directions. Rules of the guard act as in the guard. It gives
// the cost of rules before training. Directions of inputs other than price and SoC do not restrict
// single states and are not projected.
#pragma once

#include <memory>

#include "workstation/base/random.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/data/env/policy.h"

namespace bess {

// Violation count: how often a running policy violates each rule, in visited states and at random
// SoCs at the same steps. For policies whose states cannot all be checked, such as float teachers,
// and for the share of real states that a violation affects.

/// Checks and violations of one rule, in visited and in random states. A direction along price or
/// SoC is checked with the next lattice point; demands other than that and actions cannot be
/// checked in single states, and stay 0.
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
  /// Whether `action` violates the rule; none if it cannot be checked here.
  [[nodiscard]] std::optional<bool> is_broken(const Rule& rule, Action action,
                                              const MarketStep& step, std::size_t index,
                                              double soc_frac) const;

  std::shared_ptr<Policy> policy_;
  RuleSet rules_;
  ContextClasses classes_;
  int drawn_per_step_;
  mutable Random random_;
  mutable std::vector<WatchCount> counts_;
  mutable std::int64_t decisions_ = 0;
};

/// Whether RuledPolicy projects the rule.
bool can_be_projected(const Rule& rule);
/// The rules that can be projected.
RuleSet projected_rules(const RuleSet& rules);

/// Rule inputs of a step, as the edge determines them.
RulePoint rule_point_of(const MarketStep& step, double soc_frac, const ContextClasses& classes);

/// A policy under the rules that the guard enforces. `classes`: meaning of their context classes.
class GuardedPolicy : public Policy {
 public:
  GuardedPolicy(std::shared_ptr<Policy> policy, const RuleSet& rules, const ContextClasses& classes)
      : policy_(std::move(policy)), classes_(classes), guard_rules_(rules.guard_rules()) {}

  void begin(std::span<const MarketStep> ahead, double soc_frac) override {
    policy_->begin(ahead, soc_frac);
  }
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override {
    return nearest_allowed(limits_at(step, soc_frac).actions,
                           policy_->decide(step, index, soc_frac));
  }
  [[nodiscard]] double power_share_max(const MarketStep& step, double soc_frac) const override {
    return limits_at(step, soc_frac).power_permille_max / double{kFullPowerPermille};
  }

 protected:
  [[nodiscard]] RuleLimits limits_at(const MarketStep& step, double soc_frac) const {
    return rule_limits_at(guard_rules_, rule_point_of(step, soc_frac, classes_));
  }

  std::shared_ptr<Policy> policy_;
  ContextClasses classes_;
  std::vector<GuardRule> guard_rules_;
};

class RuledPolicy final : public GuardedPolicy {
 public:
  /// The rules must be consistent.
  RuledPolicy(std::shared_ptr<Policy> policy, const RuleSet& rules, const ContextClasses& classes)
      : GuardedPolicy(std::move(policy), rules, classes), implied_(rules, classes.kind) {}

  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override;

  /// Share of all decisions so far that the rules changed.
  [[nodiscard]] double changed_share() const {
    return decisions_ == 0 ? 0 : static_cast<double>(changed_) / static_cast<double>(decisions_);
  }

 private:
  ImpliedRanges implied_;
  mutable std::int64_t decisions_ = 0;
  mutable std::int64_t changed_ = 0;
};

}  // namespace bess
