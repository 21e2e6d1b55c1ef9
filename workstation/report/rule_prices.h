// Cost of the correction, split by operator rule. The cost of a rule is that of moving the plain
// student's decisions to the nearest allowed ones (ruled_policy.h), for each rule and all together;
// the difference to the corrected student is the cost of the correction itself.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/headline.h"

namespace bess {

/// Null if missing, or without carried-over days.
const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name);

/// Names of the evaluations under rules, which are not shown as policies.
inline constexpr const char* kUnderAllRules = "plain student under all rules";
std::string under_rule_name(const std::string& rule);
bool is_under_rules(std::string_view policy);

struct RulePrices {
  std::string student;              ///< kCorrectedName or kUnprovedName
  std::vector<HeadlineGain> rules;  ///< plain student under one rule minus plain student
  HeadlineGain together;            ///< plain student under all rules minus plain student
  HeadlineGain correction;          ///< own student minus plain student under all rules
  HeadlineGain total;               ///< own student minus plain student: the sum of both
};

/// None without rules that can be projected.
std::optional<RulePrices> rule_prices_of(const std::vector<NamedEvaluation>& evaluations);

/// Lines for the terminal.
std::string rule_prices_text(const RulePrices& prices);
/// One row per part: difference at each of kHeadlineWears, with standard error.
Table rule_prices_table(const RulePrices& prices);

}  // namespace bess
