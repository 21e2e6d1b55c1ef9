#include "workstation/report/figures/policy_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "workstation/correction/student/verify.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/sort_table.h"

namespace bess {

namespace {

/// Numeric order for numbers, else alphabetical.
bool comes_before(const std::string& a, const std::string& b) {
  char* end_a = nullptr;
  char* end_b = nullptr;
  const double x = std::strtod(a.c_str(), &end_a);
  const double y = std::strtod(b.c_str(), &end_b);
  const bool are_numbers = !a.empty() && !b.empty() && *end_a == 0 && *end_b == 0;
  return are_numbers ? x < y : a < b;
}

std::vector<std::string> values_of(const std::vector<HeatPoint>& points,
                                   std::string HeatPoint::*setting) {
  std::vector<std::string> values;
  for (const HeatPoint& point : points) {
    if (std::ranges::find(values, point.*setting) == values.end()) values.push_back(point.*setting);
  }
  std::ranges::sort(values, comes_before);
  return values;
}

struct Mean {
  double sum = 0, squares = 0;  ///< of values and of their errors
  int count = 0;
  [[nodiscard]] HeatValue value() const { return {sum / count, std::sqrt(squares) / count}; }
};

/// Colour by `share` of the strongest; numbers stay legible in light and dark.
std::string cell_html(const HeatValue& of, double share, const std::string& label) {
  return fmt::format(
      "<td data-label=\"{}\" title=\"\u00b1 {}\" style=\"background:color-mix(in srgb, var(--{}) "
      "{:.0f}%, var(--paper))\"><span>{}</span></td>",
      html_escaped(label), error_text(of.error, 1, kNoValue), share < 0 ? "discharge" : "charge",
      42 * std::abs(share), html_escaped(with_true_minus(fmt::format("{:.1f}", of.value))));
}

std::string shown(const std::string& value) { return value.empty() ? "as configured" : value; }

}  // namespace

HeatValue shade_of(const HeatValue& cell, const HeatValue& left) {
  if (!(std::abs(cell.value) >= 2 * cell.error)) return {0, 0};  // true for NaN
  const bool is_same = std::abs(cell.value - left.value) < 2 * std::hypot(cell.error, left.error);
  return is_same ? left : cell;
}

std::string heat_map_html(const std::vector<HeatPoint>& points, const HeatMapText& text) {
  std::map<std::pair<std::string, std::string>, Mean> means;  // by down, then across
  for (const HeatPoint& point : points) {
    if (std::isnan(point.of.value)) continue;
    Mean& mean = means[{point.down, point.across}];
    mean.sum += point.of.value;
    mean.squares += point.of.error * point.of.error;
    ++mean.count;
  }
  double most = 0;
  for (const auto& [at, mean] : means) most = std::max(most, std::abs(mean.value().value));
  const std::vector<std::string> columns = values_of(points, &HeatPoint::across);
  std::string html = fmt::format(
      "<div class=\"wide\"><table id=\"{}\">\n<caption style=\"white-space:nowrap\">{}: "
      "{} across, {} down</caption>\n"
      "<thead><tr><th scope=\"col\">{}</th>",
      html_escaped(text.id), html_escaped(text.what), html_escaped(text.across),
      html_escaped(text.down), html_escaped(text.down));
  for (const std::string& column : columns) {
    html += fmt::format("<th scope=\"col\">{}</th>", html_escaped(shown(column)));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const std::string& row : values_of(points, &HeatPoint::down)) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", html_escaped(shown(row)));
    HeatValue shade{0, 0};
    for (const std::string& column : columns) {
      const auto found = means.find({row, column});
      if (found != means.end()) shade = shade_of(found->second.value(), shade);
      html += found == means.end() ? fmt::format("<td data-label=\"{}\"><span>{}</span></td>",
                                                 html_escaped(shown(column)), kNoValue)
                                   : cell_html(found->second.value(),
                                               most > 0 ? shade.value / most : 0, shown(column));
    }
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

Json regime_marks(const std::vector<std::string>& dates) {
  Json marks = Json::list();
  for (const PriceRegime& regime : kPriceRegimes) {
    const auto from = std::lower_bound(dates.begin(), dates.end(), regime.from_date);
    if (from == dates.begin() || from == dates.end()) continue;
    marks.add(Json::list_of(static_cast<std::size_t>(from - dates.begin()), regime.change));
  }
  return marks;
}

ActionGrid student_grid(const StudentNet& net, const PolicyContext& context) {
  ActionGrid grid;
  fill_action_grid(net, context.minute_of_quarter_hour, context.quarter_hour, context.context_class,
                   false, grid);
  return grid;
}

}  // namespace bess
