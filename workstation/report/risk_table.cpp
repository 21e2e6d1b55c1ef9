#include "workstation/report/risk_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace bess {
namespace {

constexpr std::size_t kDaysOfABadOne = 20;

std::string row_of(const std::string& choice, const Evaluation& evaluation) {
  return fmt::format("{:<10} {:>7.1f} {:>9.1f} {:>10.1f} {:>7.2f}\n", choice,
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

std::string risk_table(const std::vector<NamedEvaluation>& evaluations,
                       const std::string& teacher) {
  std::string rows;
  bool is_there = false;
  const auto add = [&](const std::string& choice, const std::string& name) {
    const auto found = std::ranges::find(evaluations, name, &NamedEvaluation::name);
    if (found == evaluations.end() || found->carried_over.days.empty()) return false;
    rows += row_of(choice, found->carried_over);
    return true;
  };
  add("mean", teacher);
  for (const double share : kShownRiskShares) {
    if (add(fmt::format("cvar:{:g}", share), risk_name(teacher, share))) is_there = true;
  }
  if (!is_there) return "";
  return fmt::format(
             "what the {} chooses by, SoC carried over; EUR per day per MWh of capacity\n"
             "{:<10} {:>7} {:>9} {:>10} {:>7}\n",
             teacher, "choice", "profit", "5 % day", "worst day", "cycles") +
         rows;
}

}  // namespace bess
