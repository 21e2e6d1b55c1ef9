// Headline result of a run: profit of the exported policy, cost of its correction, and gains over
// each alternative, with and without wear.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/comparison.h"

namespace bess {

/// Names of the evaluations of a run.
inline constexpr const char* kCorrectedName = "corrected student";
inline constexpr const char* kPlainName = "plain student";
/// Replaces the corrected student when its proof failed; not exported.
inline constexpr const char* kUnprovedName = "unproved student";

/// Wear costs at which gains are shown, EUR/MWh.
inline constexpr std::array<double, 2> kHeadlineWears{0, kReferenceWearEurPerMwh};

/// Exported policy minus another one, same days, EUR per day per MWh of capacity, at each of
/// kHeadlineWears.
struct HeadlineGain {
  std::string against;  ///< name of the evaluation
  std::string meaning;  ///< as text
  std::array<PairedDifference, kHeadlineWears.size()> difference;
};

/// `exported` minus `other`, SoC carried over.
HeadlineGain gain_over(const NamedEvaluation& exported, const NamedEvaluation& other,
                       std::string_view meaning);

/// Row of kCorrectedName or kUnprovedName, SoC carried over, final charge valued, net of the
/// configured wear.
struct Headline : ComparisonRow {
  std::optional<double> reset_profit{};  ///< day-reset accounting
  /// Over the plain student under the rules: minus the cost of the correction.
  std::optional<HeadlineGain> correction{};
  std::optional<HeadlineGain> rules{};  ///< their effect on the plain student; none without rules
  std::vector<HeadlineGain> gains{};    ///< plain student first, foresight last
};

/// The same decisions at another wear cost.
Evaluation at_wear(const Evaluation& evaluation, double wear_eur_per_mwh);

/// Own student of a run: corrected or, if its proof failed, unproved; null without both.
const NamedEvaluation* find_own_student(const std::vector<NamedEvaluation>& evaluations);

/// None without a carried-over evaluation of the run's own student. An unproved student has no cost
/// of correction.
std::optional<Headline> headline_of(const std::vector<NamedEvaluation>& evaluations);

/// Outside the 95 % interval; never for one day.
bool is_shown(const PairedDifference& difference);

/// Gain over each baseline and the plain student with its verdict, one line each.
std::string gains_text(const Headline& headline);

/// "+5.2 ± 1.1 (1.4 by month)", with a true minus; unknown errors are left out.
std::string difference_text(const PairedDifference& difference);

/// Result and accounting, for the terminal.
std::string headline_text(const Headline& headline);
/// Result with errors, value of the final charge, and day-reset figure.
Json headline_json(const Headline& headline);
/// Head of the page: result, badges, gains. Escaped.
std::string headline_html(const Headline& headline);

// Cost of the correction, split by operator rule. The cost of a rule is that of moving the plain
// student's decisions to the nearest allowed ones (ruled_policy.h), for each rule and all together;
// the difference to the corrected student is the cost of the correction itself.

/// Null if missing, or without carried-over days.
const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name);

/// Names of the evaluations under rules, which are not shown as policies.
inline constexpr const char* kUnderAllRules = "plain student under all rules";
std::string under_rule_name(const std::string& rule);
bool is_under_rules(std::string_view policy);

struct RulePrices {
  std::string student;                ///< kCorrectedName or kUnprovedName
  std::vector<HeadlineGain> rules{};  ///< plain student under one rule minus plain student
  HeadlineGain together;              ///< plain student under all rules minus plain student
  HeadlineGain correction;            ///< own student minus plain student under all rules
  HeadlineGain total;                 ///< own student minus plain student: the sum of both
};

/// None without rules that can be projected.
std::optional<RulePrices> rule_prices_of(const std::vector<NamedEvaluation>& evaluations);

/// Lines for the terminal.
std::string rule_prices_text(const RulePrices& prices);
/// One row per part: difference at each of kHeadlineWears, with standard error.
Table rule_prices_table(const RulePrices& prices);

}  // namespace bess
