#include "workstation/report/figures/walk_forward_figure.h"

#include <fmt/core.h>

#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

std::string figure_text(const WalkForwardFigure& figure) {
  return fmt::format(
      "Walk-forward, each month traded by what was learnt before it: {:.1f} \u00b1 {} ({} by "
      "month) "
      "over all {} of {}",
      figure.profit, error_text(figure.errors.plain, 1), error_text(figure.errors.by_month, 1),
      counted(static_cast<std::size_t>(figure.errors.days), "day"),
      counted(static_cast<std::size_t>(figure.errors.months), "month"));
}

}  // namespace

std::string walk_forward_text(const WalkForwardOfRun& walk_forward) {
  if (!walk_forward.figure) return "No walk-forward figure: " + walk_forward.why_none + ".";
  return figure_text(*walk_forward.figure) + ".";
}

std::string walk_forward_html(const WalkForwardOfRun& walk_forward) {
  if (!walk_forward.figure) return html_escaped(walk_forward_text(walk_forward));
  return fmt::format("{}: <a href=\"{}\">its page</a>.",
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
