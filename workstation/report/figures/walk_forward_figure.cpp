#include "workstation/report/figures/walk_forward_figure.h"

#include <fmt/core.h>

#include "shared/host/text.h"
#include "workstation/base/answer.h"

namespace bess {

std::string format_omega_table(const std::vector<OmegaPoint>& points, const Evaluation& teacher) {
  std::string table = fmt::format(
      "Before repair; violations in {} states; validation and test days, SoC carried over, EUR per "
      "day per MWh of capacity\n"
      "{:>8} {:>12} {:>12} {:>12} {:>9} {:>9} {:>8} {:>6} {:>8} {:>8} {:>6} {:>8}\n",
      points.empty() ? 0 : points.front().certificate.states_checked, "omega", "property 1",
      "property 2", "property 3", "KL, nats", "agrees", "profit", "s.e.", "by month", "gain",
      "s.e.", "by month");
  table +=
      fmt::format("{:>8} {:>12} {:>12} {:>12} {:>9} {:>9} {:8.1f} {:>6} {:>8}\n", "teacher", "-",
                  "-", "-", "-", "-", teacher.profit_eur_per_day_per_mwh(),
                  error_text(teacher.errors().plain, 1), error_text(teacher.errors().by_month, 1));
  for (const OmegaPoint& p : points) {
    const PairedDifference gain = paired_difference(p.evaluation, teacher);
    table += fmt::format(
        "{:>8g} {:>12} {:>12} {:>12} {:9.4f} {:7.2f} % {:8.1f} {:>6} {:>8} {:>+8.1f} {:>6} {:>8}\n",
        p.omega, p.certificate.violations_of(1), p.certificate.violations_of(2),
        p.certificate.violations_of(3), p.divergence_nats, 100 * p.agreement,
        p.evaluation.profit_eur_per_day_per_mwh(), error_text(p.evaluation.errors().plain, 1),
        error_text(p.evaluation.errors().by_month, 1), gain.mean, error_text(gain.errors.plain, 1),
        error_text(gain.errors.by_month, 1));
  }
  return table;
}

std::string omega_csv(const std::vector<OmegaPoint>& points, const Evaluation& teacher) {
  std::string csv =
      "omega,states_checked,violations_property_1,violations_property_2,violations_property_3,"
      "divergence_nats,agreement,profit_eur_per_day_per_mwh,"
      "gain_standard_error,profit_standard_error,gain_eur_per_day_per_mwh,"
      "profit_standard_error_by_month,gain_standard_error_by_month\n";
  for (const OmegaPoint& p : points) {
    const PairedDifference gain = paired_difference(p.evaluation, teacher);
    csv += fmt::format("{:g},{},{},{},{},{:.6g},{:.6f},{:.4f},{:.4f},{:.4f},{:.4f},{},{}\n",
                       p.omega, p.certificate.states_checked, p.certificate.violations_of(1),
                       p.certificate.violations_of(2), p.certificate.violations_of(3),
                       p.divergence_nats, p.agreement, p.evaluation.profit_eur_per_day_per_mwh(),
                       gain.errors.plain, p.evaluation.errors().plain, gain.mean,
                       error_text(p.evaluation.errors().by_month, 4, ""),
                       error_text(gain.errors.by_month, 4, ""));
  }
  return csv;
}

namespace {

std::string figure_text(const WalkForwardFigure& figure) {
  return fmt::format(
      "Walk-forward (retrained before each traded month): {:.1f} \u00b1 {} ({} by month) over {} "
      "in {}",
      figure.profit, error_text(figure.errors.plain, 1), error_text(figure.errors.by_month, 1),
      counted(static_cast<std::size_t>(figure.errors.days), "day"),
      counted(static_cast<std::size_t>(figure.errors.months), "month"));
}

}  // namespace

std::string walk_forward_text(const WalkForwardOfRun& walk_forward) {
  if (!walk_forward.figure) return "No walk-forward result: " + walk_forward.why_none + ".";
  return figure_text(*walk_forward.figure) + ".";
}

std::string walk_forward_html(const WalkForwardOfRun& walk_forward) {
  if (!walk_forward.figure) return html_escaped(walk_forward_text(walk_forward));
  return fmt::format("{}: <a href=\"{}\">backtest page</a>.",
                     html_escaped(figure_text(*walk_forward.figure)),
                     html_escaped(walk_forward.figure->page));
}

Json walk_forward_json(const WalkForwardFigure& figure) {
  return Json::object({{key::kCarrySoc, true},
                       {"days", figure.errors.days},
                       {"months", figure.errors.months},
                       {key::kProfit, Decimals{figure.profit, 4}},
                       {key::kProfitError, Decimals{figure.errors.plain, 4}},
                       {key::kProfitErrorByMonth, Decimals{figure.errors.by_month, 4}},
                       {"page", figure.page}});
}

}  // namespace bess
