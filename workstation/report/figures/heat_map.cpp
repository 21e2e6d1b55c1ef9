#include "workstation/report/figures/heat_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "workstation/data/env/day_errors.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/report/figures/html.h"

namespace bess {

namespace {

std::vector<std::string> values_of(const std::vector<HeatPoint>& points,
                                   std::string HeatPoint::*setting) {
  std::vector<std::string> values;
  for (const HeatPoint& point : points) {
    if (std::ranges::find(values, point.*setting) == values.end()) values.push_back(point.*setting);
  }
  std::ranges::sort(values, {}, [](const std::string& value) { return std::stod(value); });
  return values;
}

/// Colour by `share` of the strongest; numbers stay legible in light and dark.
std::string cell_html(const HeatValue& of, double share, const std::string& label) {
  return fmt::format(
      "<td data-label=\"{}\" title=\"\u00b1 {}\" style=\"background:color-mix(in srgb, var(--{}) "
      "{:.0f}%, var(--paper))\"><span>{}</span></td>",
      html_escaped(label), error_text(of.error, 1, kNoValue), share < 0 ? "discharge" : "charge",
      42 * std::abs(share), html_escaped(with_true_minus(fmt::format("{:.1f}", of.value))));
}

}  // namespace

HeatValue shade_of(const HeatValue& cell, const HeatValue& left) {
  if (!(std::abs(cell.value) >= 2 * cell.error)) return {0, 0};  // true for NaN
  const bool is_same = std::abs(cell.value - left.value) < 2 * std::hypot(cell.error, left.error);
  return is_same ? left : cell;
}

std::string heat_map_html(const std::vector<HeatPoint>& points, const HeatMapText& text) {
  std::map<std::pair<std::string, std::string>, HeatValue> cells;  // by down, then across
  double most = 0;
  for (const auto& [across, down, of] : points) {
    if (std::isnan(of.value)) continue;
    cells[{down, across}] = {of.value + 0.0, of.error};  // + 0.0 avoids -0
    most = std::max(most, std::abs(of.value));
  }
  const std::vector<std::string> columns = values_of(points, &HeatPoint::across);
  std::string html = fmt::format(
      "<div class=\"wide\"><table id=\"{}\">\n<caption style=\"white-space:nowrap\">{}: "
      "{} across, {} down</caption>\n"
      "<thead><tr><th scope=\"col\">{}</th>",
      html_escaped(text.id), html_escaped(text.what), html_escaped(text.across),
      html_escaped(text.down), html_escaped(text.down));
  for (const std::string& column : columns) {
    html += fmt::format("<th scope=\"col\">{}</th>", html_escaped(column));
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const std::string& row : values_of(points, &HeatPoint::down)) {
    html += fmt::format("<tr><th scope=\"row\">{}</th>", html_escaped(row));
    HeatValue shade{0, 0};
    for (const std::string& column : columns) {
      const auto found = cells.find({row, column});
      if (found != cells.end()) shade = shade_of(found->second, shade);
      html += found == cells.end()
                  ? fmt::format("<td data-label=\"{}\"><span>{}</span></td>", html_escaped(column),
                                kNoValue)
                  : cell_html(found->second, most > 0 ? shade.value / most : 0, column);
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

}  // namespace bess
