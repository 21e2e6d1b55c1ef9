// Counts, while a policy runs, how often it breaks each rule: in the states that it visits and, at
// each of them, at some other SoCs drawn at random. For policies whose states cannot all be looked
// at, float teachers first; and for how much of what really happens a violation touches.
#pragma once

#include <memory>

#include "workstation/base/random.h"
#include "workstation/env/policy.h"
#include "workstation/rules/rule.h"

namespace bess {

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

}  // namespace bess
