// The integer student as a policy: exactly what the edge computes from price and SoC.
#pragma once

#include <cmath>

#include "shared/nn/student_net.h"
#include "workstation/env/policy.h"

namespace bess {

class StudentPolicy final : public Policy {
 public:
  explicit StudentPolicy(const StudentNet& net) : net_(net) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double soc_frac) const override {
    const auto soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * kSocFullE4));
    return net_.decide(
        {.minute_of_quarter_hour = step.minute_of_quarter_hour,
         .quarter_hour = step.quarter_hour,
         .context_class = net_.context.class_of(step.month, step.level_centi_eur_per_mwh),
         .soc_index = soc_index_of(soc_e4),
         .price_eur_per_mwh = lattice_price_of(price_centi_of(step.observed_eur_per_mwh))});
  }

 private:
  const StudentNet& net_;
};

}  // namespace bess
