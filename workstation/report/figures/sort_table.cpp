#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "workstation/report/figures/html.h"

namespace bess {

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

}  // namespace bess
