// From what the user typed after --policy to something that decides.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "workstation/data/env/policy.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

/// The names that --policy takes, for help and messages.
std::string policy_help();

/// Throws UserError when one of them plans on day-ahead prices and `day_ahead` is no file.
void require_outlook(const std::vector<std::string>& names, const std::string& day_ahead);

/// Throws UserError when one of them is neither known nor a model's file: before the work, not
/// after.
void require_policies(const std::vector<std::string>& names);

/// A baseline (make_baseline), the compiled array, or a model with whatever it is made of. Throws
/// UserError for an unknown name or an unreadable file.
std::shared_ptr<Policy> make_policy(const std::string& name, const MarketSteps& market,
                                    const BatteryParameters& battery);

/// What the context classes of rules mean for a policy: the student's or the teacher's own, else
/// those that would be fitted on the training days of `market`.
ContextClasses context_of_policy(const std::string& policy, const MarketSteps& market,
                                 ContextKind otherwise);

}  // namespace bess
