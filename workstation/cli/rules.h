// The subcommands of `bess-train rules`, one file each, and what they share.
#pragma once

#include <string>

#include "shared/context_classes.h"
#include "shared/host/command_line.h"
#include "workstation/cli/distilled_prices.h"
#include "workstation/env/market_steps.h"

namespace bess {

inline constexpr const char* kAllTogether = "all together";

void add_rules_check(ProgramCommand& rules);
void add_rules_map(ProgramCommand& rules);
void add_rules_price(ProgramCommand& rules);

/// What the context classes of rules mean for a policy: the student's or the teacher's own, else those that would
/// be fitted on the training days of `market`.
ContextClasses context_of_policy(const std::string& policy, const MarketSteps& market,
                                 ContextKind otherwise);

}  // namespace bess
