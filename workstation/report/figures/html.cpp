#include "workstation/report/figures/html.h"

#include <fmt/core.h>

#include "workstation/report/figures/page_files.h"

namespace bess {
namespace {

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

std::string style_sheet() { return std::string(page_file("document.css")); }

std::string format_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n"
      "</html>\n",
      html_escaped(title), style_sheet(), body);
}

}  // namespace bess
