#include "workstation/report/risk_page.h"

#include <fmt/core.h>

#include "workstation/env/day_risk.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/rule_prices.h"

namespace bess {
namespace {

constexpr const char* kUnknown = "\u2013";

std::string ratio(const std::optional<double>& value) {
  return value ? fmt::format("{:.2f}", *value) : kUnknown;
}

std::string percent(double share) { return fmt::format("{:.0f}", 100 * share); }

}  // namespace

std::string risk_html(const std::vector<NamedEvaluation>& evaluations) {
  if (evaluations.empty() || evaluations.front().carried_over.days.empty()) return {};
  const NamedEvaluation& first = evaluations.front();
  HtmlTable table{fmt::format("Day by day, {} days", first.carried_over.days.size()),
                  {"Policy", "Won, % of days", "Value at risk 95 %", "Drawdown", "Sortino",
                   fmt::format("Beat {}, % of days", first.name), "Sortino of the gain"},
                  {}};
  for (const NamedEvaluation& named : evaluations) {
    if (named.carried_over.days.empty() || is_under_rules(named.name)) continue;
    const DayRisk risk = day_risk(daily_profits(named.carried_over));
    std::vector<std::string> cells{named.name,
                                   percent(risk.win_rate),
                                   fmt::format("{:.1f}", risk.value_at_risk),
                                   fmt::format("{:.1f}", risk.drawdown),
                                   ratio(risk.sortino),
                                   kUnknown,
                                   kUnknown};
    if (&named != &first) {
      const DayRisk gain = day_risk(daily_gains(named.carried_over, first.carried_over));
      cells[5] = percent(gain.win_rate);
      cells[6] = ratio(gain.sortino);
    }
    table.rows.push_back(std::move(cells));
  }
  return format_table(table) +
         fmt::format(
             "<p class=\"note\">EUR per MWh of capacity, the charge carried over. Won: days "
             "that brought more than nothing. Value at risk: the loss that 19 of 20 days stay "
             "above (minus the 5 % quantile); negative when even that day earned. Drawdown: "
             "deepest "
             "fall of the cumulative profit from the end of a day to that of a later one, the "
             "beginning being 0. Sortino: mean day over the downside deviation, the root of the "
             "mean of the squared losses over all days, not annualised; {} when no day lost. "
             "Of the gain: the same of the day-by-day difference to {}.</p>\n",
             kUnknown, html_escaped(first.name));
}

}  // namespace bess
