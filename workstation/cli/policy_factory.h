// From what the user typed after --policy to something that decides.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "workstation/cli/run_config.h"
#include "workstation/env/policy.h"
#include "workstation/rl/risk.h"

namespace bess {

/// The names that --policy takes, for help and messages.
inline constexpr const char* kPolicyHelp =
    "rbc (thresholds 11/179), rbc:LOW:HIGH, rbc-quartile (training days' quartiles), rbc-tuned "
    "(thresholds that earn most on the training days), tabular, mpc (rolling horizon on a naive "
    "forecast), sdp (stochastic program by hour and price level), sdp-hour (by hour alone), "
    "sdp-outlook (planned each day on --day-ahead), "
    "foresight, compiled (the array in this program), or a teacher's or student's file";

/// Throws UserError when sdp-outlook is among them and `day_ahead` is no file.
void require_outlook(const std::vector<std::string>& names, const std::string& day_ahead);

/// Throws UserError when one of them is neither known nor a model's file: before the work, not after.
void require_policies(const std::vector<std::string>& names);

/// A policy with whatever it is made of; the baselines that are fitted are fitted on the training
/// days of `market`, which may differ in its delay from the market they run on. Throws UserError for an unknown name or an unreadable file.
std::shared_ptr<Policy> make_policy(const std::string& name, const MarketSteps& market,
                                    const BatteryParameters& battery, const Risk& risk = {});

/// Quartiles of the training days' settled prices: the rule without look-ahead.
std::pair<double, double> training_quartiles(const MarketSteps& market);

}  // namespace bess
