#include "workstation/report/risk_table.h"

#include <fmt/format.h>

#include <algorithm>

#include "workstation/report/figures/html.h"

namespace bess {
namespace {

constexpr std::size_t kDaysOfABadOne = 20;

std::string row_of(const RiskChoice& choice) {
  const Evaluation& evaluation = *choice.evaluation;
  return fmt::format("{:<10} {:>7.1f} {:>9.1f} {:>10.1f} {:>7.2f}\n", choice.name,
                     evaluation.profit_eur_per_day_per_mwh(), bad_day_eur_per_mwh(evaluation),
                     evaluation.worst_day_eur_per_mwh(), evaluation.cycles_per_day());
}

}  // namespace

std::string risk_name(const std::string& teacher, double worst_share) {
  return fmt::format("{}, cvar:{:g}", teacher, worst_share);
}

double bad_day_eur_per_mwh(const Evaluation& evaluation) {
  std::vector<double> profits;
  for (const DayResult& day : evaluation.days) {
    profits.push_back(day.profit_eur / evaluation.capacity_mwh);
  }
  const auto at = static_cast<std::ptrdiff_t>((profits.size() - 1) / kDaysOfABadOne);
  std::ranges::nth_element(profits, profits.begin() + at);
  return profits[static_cast<std::size_t>(at)];
}

std::vector<RiskChoice> risk_choices(const std::vector<NamedEvaluation>& evaluations,
                                     const std::string& teacher) {
  std::vector<RiskChoice> choices;
  const auto add = [&](const std::string& choice, const std::string& name) {
    const auto found = std::ranges::find(evaluations, name, &NamedEvaluation::name);
    if (found == evaluations.end() || found->carried_over.days.empty()) return;
    choices.push_back({choice, &found->carried_over});
  };
  add("mean", teacher);
  for (const double share : kShownRiskShares) {
    add(fmt::format("cvar:{:g}", share), risk_name(teacher, share));
  }
  return choices.size() > 1 ? choices : std::vector<RiskChoice>{};
}

std::string risk_table(const std::vector<NamedEvaluation>& evaluations,
                       const std::string& teacher) {
  const std::vector<RiskChoice> choices = risk_choices(evaluations, teacher);
  if (choices.empty()) return "";
  std::string text = fmt::format(
      "what the {} chooses by, SoC carried over; EUR per day per MWh of capacity\n"
      "{:<10} {:>7} {:>9} {:>10} {:>7}\n",
      teacher, "choice", "profit", "5 % day", "worst day", "cycles");
  for (const RiskChoice& choice : choices) text += row_of(choice);
  return text;
}

std::string risk_choice_html(const std::vector<NamedEvaluation>& evaluations,
                             const std::string& teacher) {
  HtmlTable table{fmt::format("What the {} chooses by, SoC carried over", teacher),
                  {"Choice", "Profit", "5 % day", "Worst day", "Cycles a day"},
                  {}};
  for (const RiskChoice& choice : risk_choices(evaluations, teacher)) {
    const Evaluation& evaluation = *choice.evaluation;
    table.rows.push_back({choice.name,
                          fmt::format("{:.1f}", evaluation.profit_eur_per_day_per_mwh()),
                          fmt::format("{:.1f}", bad_day_eur_per_mwh(evaluation)),
                          fmt::format("{:.1f}", evaluation.worst_day_eur_per_mwh()),
                          fmt::format("{:.2f}", evaluation.cycles_per_day())});
  }
  if (table.rows.empty()) return {};
  return format_table(table) +
         "<p class=\"note\">EUR per day per MWh of capacity. The same teacher, which knows how "
         "returns are distributed: choosing by their mean, or by the mean of their worst tenth "
         "(cvar:0.1) or quarter. 5 % day: one day in twenty brings no more; of fewer than "
         "twenty-one days the worst. <code>bess-train distil --risk cvar:0.1</code> makes a "
         "student of such a choice.</p>\n";
}

}  // namespace bess
