// Comparison of policies on the same days, with standard errors of the differences to the first
// one, as text, CSV and HTML.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/base/table.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/policy/planners/baselines.h"

namespace bess {

/// One policy in both accountings; an Evaluation without days was not made.
struct NamedEvaluation {
  std::string name;
  Evaluation day_reset;
  Evaluation carried_over;
  std::string description{};  ///< fitted parameters; may be empty

  /// One that was made: both have the same battery, wear and months.
  [[nodiscard]] const Evaluation& any() const {
    return day_reset.days.empty() ? carried_over : day_reset;
  }
};

/// Null if there is none of this name.
const NamedEvaluation* find_evaluation(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name);

/// Reference wear cost: every table also shows the profit at this wear, to compare policies with
/// different throughput.
inline constexpr double kReferenceWearEurPerMwh = 10;

/// One row of a table, in EUR per day per MWh of capacity.
struct ComparisonRow {
  std::string name;
  bool carry_soc = false;
  std::size_t days;
  double profit;
  DayErrors errors;                              ///< of the profit
  ChargeLeft charge_left;                        ///< of the profit
  double profit_at_reference_wear;               ///< of the same decisions
  std::optional<PairedDifference> difference{};  ///< to the first policy; none for itself
  std::string gain_over{};                       ///< name of the first policy
  double worst_day;
  double cycles_per_day;
  double switches_per_day;
  double soc_end_frac_mean;
  std::optional<double> foresight_share{};  ///< of the foresight profit, if known and > 0
};

/// Accounting of a table.
using EvaluationField = Evaluation NamedEvaluation::*;

/// One row per policy with this evaluation, in order. Shares are of the policy named foresight,
/// else of `given`.
std::vector<ComparisonRow> comparison_rows(const std::vector<NamedEvaluation>& evaluations,
                                           EvaluationField field,
                                           const NamedEvaluation* given = nullptr);

/// Row of one evaluation; without gain if `first` is null.
ComparisonRow comparison_row(const std::string& name, const Evaluation& evaluation,
                             const Evaluation* first, const Evaluation* foresight = nullptr);

/// Table with all columns; its keys are shared with answers (../base/answer.h).
Table figures_table(const std::vector<ComparisonRow>& rows);
/// Adds the figures of `row` to an answer.
void add_figures(const ComparisonRow& row, Json& json);

/// Text table, one block per available accounting.
std::string format_comparison_table(const std::vector<NamedEvaluation>& evaluations,
                                    const NamedEvaluation* foresight = nullptr);

/// Valuation of the final charge, as text.
std::string charge_left_meaning(double price_eur_per_mwh);
/// Head of its column.
inline constexpr const char* kReferenceWearHead = "at wear 10";
/// Meaning of the profit at the reference wear, as text; `wear_eur_per_mwh` is configured.
std::string reference_wear_meaning(double wear_eur_per_mwh);
/// Header `policy,soc,days,...`; an empty field is "not applicable".
std::string comparison_csv(const std::vector<NamedEvaluation>& evaluations,
                           const NamedEvaluation* foresight = nullptr);

// Evaluation days: their split and relation to training, and daily results as CSV with exact
// numbers, from which tables and paired differences can be recomputed.

// Evaluation days of a result. Days 26 to the end of each month are held out, but training may
// include later months.

struct JudgedDays {
  Split split;
  std::vector<std::string> dates;  ///< ascending, "2023-01-31"
  std::string last_learnt;         ///< last training or validation day; empty: unknown

  [[nodiscard]] std::size_t before_last_learnt() const;  ///< number of evaluation days before it
  [[nodiscard]] std::size_t months() const;
};

/// Last training or validation day; empty without any.
std::string last_learnt_day(const MarketSteps& market);

JudgedDays judged_days(const MarketSteps& market, Split split);

/// Two sentences: split with its days, and relation to the training days.
std::string judged_days_text(const JudgedDays& judged);
Json judged_days_json(const JudgedDays& judged);

/// Header `policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,
/// soc_start_frac,charge_value_eur,charge_price_eur_per_mwh`; no price: the final charge is not
/// valued.
std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations);

/// Reads it for the evaluated battery; policies keep their order. Throws UserError naming `name`
/// and the line.
std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery);

}  // namespace bess
