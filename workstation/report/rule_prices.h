// What the correction cost, split into what each rule of the operator costs and what is left for
// the correction itself. A rule's price is that of the plain student's decisions moved to the
// nearest ones that the rule leaves (ruled_policy.h), alone and with all others; what lies between
// that and the corrected student is the correction's.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/headline.h"

namespace bess {

/// Null where it is not among them, or no day of it was carried over.
const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name);

/// Names of the evaluations that it is made from: parts of a price, no rivals, left out of tables
/// of policies.
inline constexpr const char* kUnderAllRules = "plain student under all rules";
std::string under_rule_name(const std::string& rule);
bool is_under_rules(std::string_view policy);

struct RulePrices {
  std::string student;              ///< kCorrectedName or kUnprovedName
  std::vector<HeadlineGain> rules;  ///< alone: plain student under the rule minus plain student
  HeadlineGain together;            ///< the same under all of them
  HeadlineGain correction;          ///< that student minus plain student under all rules
  HeadlineGain total;               ///< that student minus plain student: the sum of both
};

/// None without rules that can be projected.
std::optional<RulePrices> rule_prices_of(const std::vector<NamedEvaluation>& evaluations);

/// Lines for the terminal.
std::string rule_prices_text(const RulePrices& prices);
/// A row a part: the difference at each of kHeadlineWears with its standard error.
Table rule_prices_table(const RulePrices& prices);

}  // namespace bess
