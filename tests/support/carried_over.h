// Policies on chained days, each starting with the charge that the previous day left.
#pragma once

#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

inline constexpr EvaluationOptions kCarriedOver{.battery = {}, .carry_soc = true};

/// Actions of the days before an instant.
inline std::vector<Action> actions_before(const MarketSteps& market,
                                          const std::vector<MarketDay>& days, Policy& policy,
                                          std::int64_t until_utc_s,
                                          const EvaluationOptions& options = kCarriedOver) {
  std::vector<StepRecord> records;
  evaluate(market, days, policy, options, &records);
  std::vector<Action> actions;
  for (const StepRecord& r : records) {
    if (r.utc_s < until_utc_s) actions.push_back(r.action);
  }
  return actions;
}

}  // namespace bess
