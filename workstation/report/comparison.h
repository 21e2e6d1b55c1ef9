// Policies side by side: what each earned on the same days, and how sure the difference to the
// first one is. One computation, three shapes: terminal table, CSV, and the report's HTML table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/base/table.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {

/// One policy on the same days in both ways of counting. An Evaluation without days was not made.
struct NamedEvaluation {
  std::string name;
  Evaluation day_reset;
  Evaluation carried_over;
  std::string description{};  ///< what was chosen in fitting it; may be empty
};

/// Wear at which every table shows the profit once more, whatever wear is configured: policies that
/// trade more or less are compared by what wearing out the battery leaves of it.
inline constexpr double kReferenceWearEurPerMwh = 10;
inline constexpr const char* kReferenceWearKey = "profit_at_wear_10_eur_per_day_per_mwh";

/// One line of a table. Money in EUR per day per MWh of capacity.
struct ComparisonRow {
  std::string name;
  bool carry_soc;
  std::size_t days;
  double profit;
  DayErrors errors;                            ///< of the profit
  ChargeLeft charge_left;                      ///< of the profit
  double profit_at_reference_wear;             ///< of the same decisions
  std::optional<PairedDifference> difference;  ///< to the first policy; none for itself
  std::string gain_over{};                     ///< whose the difference is to
  double worst_day;
  double cycles_per_day;
  double switches_per_day;
  double soc_end_frac_mean;
  std::optional<double> foresight_share;  ///< of the foresight profit, when it is there and > 0
};

/// Which of the two evaluations a table is about.
using EvaluationField = Evaluation NamedEvaluation::*;

/// One row per policy that has this evaluation, in order. Shares are of the policy named foresight
/// or, when it is not among them, of `given`.
std::vector<ComparisonRow> comparison_rows(const std::vector<NamedEvaluation>& evaluations,
                                           EvaluationField field,
                                           const NamedEvaluation* given = nullptr);

/// The row of one evaluation; `first` null: without a gain.
ComparisonRow comparison_row(const std::string& name, const Evaluation& evaluation,
                             const Evaluation* first, const Evaluation* foresight = nullptr);

/// Every figure of the rows; its keys are those that answers and tables share (../base/answer.h).
Table figures_table(const std::vector<ComparisonRow>& rows);
/// The figures of `row` that every answer has.
void add_figures(const ComparisonRow& row, Json& json);

/// Aligned columns for the terminal: a block per way of counting, the missing one left out.
std::string format_comparison_table(const std::vector<NamedEvaluation>& evaluations,
                                    const NamedEvaluation* foresight = nullptr);

/// At what the charge left at the end is valued, for people.
std::string charge_left_meaning(double price_eur_per_mwh);
/// How both ways of counting treat the charge at the end; for people, with line ends.
std::string charge_meaning(const std::vector<NamedEvaluation>& evaluations);

/// In how many months the days of these lie; all have the same.
int months_of(const std::vector<NamedEvaluation>& evaluations);

/// The head of its column.
inline constexpr const char* kReferenceWearHead = "at wear 10";
/// What the profit at the reference wear is, for people, where `wear_eur_per_mwh` is configured.
std::string reference_wear_meaning(double wear_eur_per_mwh);
/// The wear that the profits of these are net of.
double configured_wear_eur_per_mwh(const std::vector<NamedEvaluation>& evaluations);

/// Header `policy,soc,days,...`; an empty field is "not applicable".
std::string comparison_csv(const std::vector<NamedEvaluation>& evaluations,
                           const NamedEvaluation* foresight = nullptr);

}  // namespace bess
