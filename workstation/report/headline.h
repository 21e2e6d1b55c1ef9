// What an operator asks first of a run: what would the policy that would be exported have earned, what did its
// correction cost, and how does it stand against each alternative, without wear and with it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// Names by which the evaluations of a run are recognised.
inline constexpr const char* kCorrectedName = "corrected student";
inline constexpr const char* kPlainName = "plain student";

/// The wears, EUR/MWh, at which gains are shown, whatever is configured.
inline constexpr std::array<double, 2> kHeadlineWears{0, kReferenceWearEurPerMwh};

/// Exported policy minus another one, same days, EUR per day per MWh of capacity, at each of kHeadlineWears.
struct HeadlineGain {
  std::string against;  ///< name of the evaluation
  std::string meaning;  ///< for people
  std::array<PairedDifference, kHeadlineWears.size()> difference;
};

/// `exported` minus `other`, each day from the same SoC.
HeadlineGain gain_over(const NamedEvaluation& exported, const NamedEvaluation& other,
                       std::string_view meaning);

struct Headline {
  std::size_t days;
  double profit;     ///< EUR per day per MWh of capacity, net of the configured wear
  DayErrors errors;  ///< of the profit
  std::optional<double> foresight_share;
  std::optional<HeadlineGain>
      correction;  ///< against the plain student under the rules: the price of correction, negated
  std::optional<HeadlineGain> rules;  ///< what they change of the plain student; none without any
  std::vector<HeadlineGain> gains;    ///< the plain student first, foresight last
};

/// The same decisions, had wear cost this much instead.
Evaluation at_wear(const Evaluation& evaluation, double wear_eur_per_mwh);

/// None without an evaluation of the corrected student. Every day starts at the same SoC.
std::optional<Headline> headline_of(const std::vector<NamedEvaluation>& evaluations);

/// Beyond the interval of 95 %; never of one day.
bool is_shown(const PairedDifference& difference);

/// "+5.2 ± 1.1 (1.4 by month)", with a true minus; an error that is not known is left out.
std::string difference_text(const PairedDifference& difference);

/// The head of the page: the figure, the badges, the gains. Escaped.
std::string headline_html(const Headline& headline);

}  // namespace bess
