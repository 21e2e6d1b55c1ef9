#include "workstation/report/figures/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/market/series/imbalance_price.h"

namespace bess {

namespace {

/// In order of dependency.
constexpr std::string_view kScripts[] = {
    "chart.min.js", "student.js",    "archive.js",    "charts.js",   "tear_sheet.js",
    "day.js",       "rule_boxes.js", "policy_map.js", "learning.js", "page.js"};
constexpr std::string_view kPlainScripts[] = {"chart.min.js", "charts.js", "plain_charts.js"};

std::string scripts_of(std::span<const std::string_view> names) {
  std::string text;
  for (const std::string_view name : names) {
    text += fmt::format("<script>\n{}</script>\n", page_file(name));
  }
  return text;
}

std::string table_row(const std::vector<std::string>& cells,
                      const std::vector<std::string>& header) {
  std::string text = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += i == 0 ? fmt::format("<th scope=\"row\">{}</th>", html_escaped(cells[i]))
                   : fmt::format("<td data-label=\"{}\">{}</td>", html_escaped(header[i]),
                                 html_escaped(with_true_minus(cells[i])));
  }
  return text + "</tr>\n";
}

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

std::string format_table(const HtmlTable& table) {
  std::string text = fmt::format("<div class=\"wide\"><table>\n<caption>{}</caption>\n<thead><tr>",
                                 html_escaped(table.caption));
  for (const std::string& cell : table.header) {
    text += fmt::format("<th scope=\"col\">{}</th>", html_escaped(cell));
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) text += table_row(row, table.header);
  return text + "</tbody></table></div>\n";
}

std::string format_table(const std::string& caption, const Table& table) {
  HtmlTable shown{caption, {}, std::vector<std::vector<std::string>>(table.size())};
  for (const auto& [name, values] : table.columns()) {
    if (name.title.empty()) continue;
    shown.header.push_back(name.title);
    for (std::size_t row = 0; row < values.size(); ++row) {
      shown.rows[row].push_back(shown_value(values[row], name, kNoValue));
    }
  }
  return format_table(shown);
}

Cell text_cell(const std::string& text) {
  return {html_escaped(with_true_minus(text)), text, true};
}
Cell no_text_cell() { return {kNoValue, {}, true}; }

Cell number_cell(const std::string& text, double value) {
  if (std::isnan(value)) return {kNoValue};
  return {html_escaped(with_true_minus(text)), fmt::format("{}", value)};
}

Cell number_cell(double value, int decimals) {
  return number_cell(fmt::format("{:.{}f}", value, decimals), value);
}

SortTable sort_table(const std::string& id, const std::string& caption, const Table& table) {
  SortTable shown{id, caption, {}, std::vector<std::vector<Cell>>(table.size())};
  for (const auto& [name, values] : table.columns()) {
    if (name.title.empty()) continue;
    shown.header.push_back(name.title);
    for (std::size_t row = 0; row < values.size(); ++row) {
      const TableValue& value = values[row];
      shown.rows[row].push_back(value.is_text
                                    ? text_cell(value.text)
                                    : number_cell(shown_value(value, name), value.number));
    }
  }
  return shown;
}

std::string sort_table_html(const SortTable& table) {
  std::string text = fmt::format(
      "<div class=\"wide\"><table class=\"sortable\" id=\"{}\">\n"
      "<caption>{}</caption>\n<thead><tr>",
      table.id, html_escaped(table.caption));
  for (std::size_t c = 0; c < table.header.size(); ++c) {
    const bool is_text =
        std::ranges::any_of(table.rows, [&](const auto& row) { return row[c].is_text; });
    text += fmt::format("<th scope=\"col\"{}><button type=\"button\">{}</button></th>",
                        is_text ? " class=\"text\"" : "", html_escaped(table.header[c]));
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    text += "<tr>";
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string sort = fmt::format("data-sort=\"{}\"", html_escaped(row[c].sort));
      text += c == 0 ? fmt::format("<th scope=\"row\" {}>{}</th>", sort, row[c].html)
                     : fmt::format("<td data-label=\"{}\" {}{}><span>{}</span></td>",
                                   html_escaped(table.header[c]), sort,
                                   row[c].is_text ? " class=\"text\"" : "", row[c].html);
    }
    text += "</tr>\n";
  }
  return text + "</tbody></table></div>\n";
}

std::string exact(double value) {
  const std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? text.substr(1) : text;
}

std::string csv_link(std::string_view file) {
  return fmt::format("<a class=\"csv\" href=\"{0}\" download>{0}</a>", html_escaped(file));
}

std::string format_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n"
      "</html>\n",
      html_escaped(title), page_file("document.css"), body);
}

std::string filled_in(std::string_view template_text,
                      const std::map<std::string, std::string>& parts) {
  std::string text;
  for (;;) {
    const std::size_t open = template_text.find("{{");
    text += template_text.substr(0, open);
    if (open == std::string_view::npos) return text;
    const std::size_t close = template_text.find("}}", open);
    const std::string name(template_text.substr(open + 2, close - open - 2));
    const auto part = parts.find(name);
    if (part == parts.end()) throw std::logic_error("the page has no part \"" + name + "\"");
    text += part->second;
    template_text.remove_prefix(close + 2);
  }
}

std::string script_safe(std::string json) {
  replace_all(json, "<", "\\u003c");
  return json;
}

std::string format_report_page(const std::map<std::string, std::string>& parts, const Json& data) {
  std::map<std::string, std::string> all = parts;
  all["style"] = std::string(page_file("document.css")).append(page_file("report.css"));
  all["data"] = script_safe(data.line());
  all["scripts"] = scripts_of(kScripts);
  return filled_in(page_file("report.html"), all);
}

std::string format_chart_page(std::string_view title, std::string body, Json charts) {
  body += fmt::format("<script type=\"application/json\" id=\"data\">{}</script>\n{}",
                      script_safe(charts.line()), scripts_of(kPlainScripts));
  return format_page(title, body);
}

std::string chart_html(std::string_view id, std::string_view alt) {
  return fmt::format(
      "<div class=\"chart tall\"><canvas id=\"{}\" role=\"img\" "
      "aria-label=\"{}\"></canvas></div>\n",
      id, html_escaped(alt));
}

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
