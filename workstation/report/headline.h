// What an operator asks first of a run: what would the policy that would be exported have earned,
// what did its correction cost, and how does it stand against each alternative, without wear and
// with it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/comparison.h"

namespace bess {

/// Names by which the evaluations of a run are recognised.
inline constexpr const char* kCorrectedName = "corrected student";
inline constexpr const char* kPlainName = "plain student";
/// In place of the corrected one where its proof failed: nobody may export it.
inline constexpr const char* kUnprovedName = "unproved student";

/// The wears, EUR/MWh, at which gains are shown, whatever is configured.
inline constexpr std::array<double, 2> kHeadlineWears{0, kReferenceWearEurPerMwh};

/// Exported policy minus another one, same days, EUR per day per MWh of capacity, at each of
/// kHeadlineWears.
struct HeadlineGain {
  std::string against;  ///< name of the evaluation
  std::string meaning;  ///< for people
  std::array<PairedDifference, kHeadlineWears.size()> difference;
};

/// `exported` minus `other`, SoC carried over.
HeadlineGain gain_over(const NamedEvaluation& exported, const NamedEvaluation& other,
                       std::string_view meaning);

/// Charge carried over from day to day, what is left of it at the end valued; EUR per day per MWh
/// of capacity, net of the configured wear.
struct Headline {
  std::string student;  ///< kCorrectedName or kUnprovedName
  std::size_t days;
  double profit;
  DayErrors errors;                    ///< of the profit
  std::optional<double> reset_profit;  ///< friendlier: each day from the same charge, its end free
  ChargeLeft charge_left;              ///< a part of the profit
  std::optional<double> foresight_share;
  std::optional<HeadlineGain>
      correction;  ///< against the plain student under the rules: the price of correction, negated
  std::optional<HeadlineGain> rules;  ///< what they change of the plain student; none without any
  std::vector<HeadlineGain> gains;    ///< the plain student first, foresight last
};

/// The same decisions, had wear cost this much instead.
Evaluation at_wear(const Evaluation& evaluation, double wear_eur_per_mwh);

/// The policy that a run is about: corrected student or, where its proof failed, unproved one; null
/// without both.
const NamedEvaluation* find_own_student(const std::vector<NamedEvaluation>& evaluations);

/// None without an evaluation of the run's own student, SoC carried over. An unproved student has
/// no price of correction: its correction was not finished.
std::optional<Headline> headline_of(const std::vector<NamedEvaluation>& evaluations);

/// Beyond the interval of 95 %; never of one day.
bool is_shown(const PairedDifference& difference);

/// "+5.2 ± 1.1 (1.4 by month)", with a true minus; an error that is not known is left out.
std::string difference_text(const PairedDifference& difference);

/// How the figure counts: carried over, the charge left at what price, and the friendlier figure.
/// For people.
std::string headline_accounting(const Headline& headline);
/// The figure in a line, for the terminal, with how it counts.
std::string headline_text(const Headline& headline);
/// The figure with its errors, the valued charge and the friendlier figure.
Json headline_json(const Headline& headline);
/// The head of the page: the figure, the badges, the gains. Escaped.
std::string headline_html(const Headline& headline);

}  // namespace bess
