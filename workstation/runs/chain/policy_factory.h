// Policy factory: from the text after --policy to a policy.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "workstation/data/env/policy.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

/// Values of --policy, for help and messages.
std::string policy_help();

/// Throws UserError when one of them plans on day-ahead prices and `day_ahead` is empty.
void require_outlook(const std::vector<std::string>& names, const std::string& day_ahead);

/// Throws UserError when one of them is neither a known name nor a model file. Call before work.
void require_policies(const std::vector<std::string>& names);

/// Baseline (make_baseline), compiled array, or model file. Throws UserError for an unknown name or
/// an unreadable file.
std::shared_ptr<Policy> make_policy(const std::string& name, const MarketSteps& market,
                                    const BatteryParameters& battery);

/// Context classes for rules: those of the student or teacher, else fitted on the training days of
/// `market`.
ContextClasses context_of_policy(const std::string& policy, const MarketSteps& market,
                                 ContextKind otherwise);

}  // namespace bess
