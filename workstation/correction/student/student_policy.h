// Integer student as a policy: exactly the edge's computation from price and SoC. Also the exported
// policy: student plus the rules that the guard enforces, as on the edge. It includes the cost of
// power limits, which only the guard applies.
#pragma once

#include <cmath>
#include <memory>
#include <utility>

#include "workstation/correction/rules/ruled_policy.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/env/policy.h"

namespace bess {

class StudentPolicy final : public Policy {
 public:
  /// Keeps a reference to the net. `plan_cache`: plans for the outlook context.
  explicit StudentPolicy(const StudentNet& net,
                         std::shared_ptr<const PlanCache> plan_cache = nullptr)
      : net_(net), plan_cache_(std::move(plan_cache)) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override {
    const std::int32_t price_centi =
        plan_cache_ ? plan_cache_->break_even_centi(step, soc_frac) : step.level_centi_eur_per_mwh;
    const auto soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * kSocFullE4));
    return net_.decide(
        {.minute_of_quarter_hour = step.minute_of_quarter_hour,
         .quarter_hour = step.quarter_hour,
         .context_class = net_.context.class_of(step.month, price_centi),
         .soc_index = soc_index_of(soc_e4),
         .price_eur_per_mwh = lattice_price_of(price_centi_of(step.observed_eur_per_mwh))});
  }

 private:
  const StudentNet& net_;
  std::shared_ptr<const PlanCache> plan_cache_;
};

/// Keeps a reference: `student` must outlive it.
inline std::unique_ptr<Policy> exported_policy(const StudentFile& student) {
  auto policy = std::make_unique<StudentPolicy>(student.net, student.outlook);
  const RuleSet& rules = student.certificate.rules;
  if (rules.guard_rules().empty()) return policy;
  return std::make_unique<GuardedPolicy>(std::move(policy), rules, student.net.context);
}

}  // namespace bess
