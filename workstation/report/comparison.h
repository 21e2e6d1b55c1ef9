// Policies side by side: what each earned on the same days, and how sure the difference to the
// first one is. One computation, three shapes: terminal table, CSV, and the report's HTML table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/env/evaluate.h"

namespace bess {

/// One policy on the same days in both ways of counting. An Evaluation without days was not made.
struct NamedEvaluation {
  std::string name;
  Evaluation day_reset;
  Evaluation carried_over;
  std::string description{};  ///< what was chosen in fitting it; may be empty
};

/// The name by which the perfect-foresight bound is recognised.
inline constexpr const char* kForesightName = "foresight";

/// One line of a table. Money in EUR per day per MWh of capacity.
struct ComparisonRow {
  std::string name;
  std::size_t days;
  double profit;
  double standard_error;
  std::optional<PairedDifference> difference;  ///< to the first policy; none for itself
  double worst_day;
  double cycles_per_day;
  double switches_per_day;
  std::optional<double> foresight_share;  ///< of the foresight profit, when it is there and > 0
};

/// Which of the two evaluations a table is about.
using EvaluationField = Evaluation NamedEvaluation::*;

/// One row per policy that has this evaluation, in order. Shares are of the policy named foresight
/// or, when it is not among them, of `foresight`.
std::vector<ComparisonRow> comparison_rows(const std::vector<NamedEvaluation>& evaluations,
                                           EvaluationField field,
                                           const NamedEvaluation* foresight = nullptr);

/// Aligned columns for the terminal: a block per way of counting, the missing one left out.
std::string format_comparison_table(const std::vector<NamedEvaluation>& evaluations,
                                    const NamedEvaluation* foresight = nullptr);

/// Header `policy,soc,days,...`; soc is "reset" or "carried"; an empty field is "not applicable".
std::string comparison_csv(const std::vector<NamedEvaluation>& evaluations,
                           const NamedEvaluation* foresight = nullptr);

}  // namespace bess
