#include "workstation/report/html.h"

#include <fmt/core.h>

#include "workstation/report/palette.h"

namespace bess {
namespace {

constexpr std::string_view kStyle = R"(
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);
 font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,Helvetica,Arial,sans-serif}
main{max-width:60rem;margin:0 auto;padding:1.5rem 1rem 4rem}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .6rem}
h2{font-size:1.2rem;margin:2.6rem 0 .5rem}
p{max-width:44rem;margin:.5rem 0}
.lead{font-size:1.08rem}
figure{margin:2.6rem 0}
figure h2{margin:0 0 .6rem}
figcaption{margin-top:.6rem}
figcaption,.note{color:var(--muted);font-size:.92rem;max-width:44rem}
.wide{overflow-x:auto;-webkit-overflow-scrolling:touch}
svg{display:block;width:100%;min-width:36rem;height:auto}
svg text{font-family:system-ui,-apple-system,"Segoe UI",Roboto,Helvetica,Arial,sans-serif}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:.92rem;margin:1rem 0}
caption{text-align:left;font-weight:600;padding:.3rem 0}
th,td{padding:.32rem .45rem;text-align:right;white-space:nowrap;border-bottom:1px solid var(--grid)}
th:first-child,td:first-child{text-align:left;padding-left:0}
thead th{white-space:normal;color:var(--muted);font-weight:600;vertical-align:bottom;border-bottom-color:var(--muted)}
tbody th{font-weight:400}
pre{font-size:.8rem;white-space:pre-wrap;overflow-wrap:anywhere;color:var(--muted)}
@media print{main{max-width:none;padding:0}figure,table,.block{break-inside:avoid}h2{break-after:avoid}
 .wide{overflow:visible}svg{min-width:0}body{font-size:11pt}}
)";

std::string variables(std::string_view Colour::*shade) {
  std::string text;
  for (const Colour& colour : kPalette) text += fmt::format("--{}:{};", colour.name, colour.*shade);
  return text;
}

/// Dark only on screens that ask for it: paper stays white.
std::string colour_scheme() {
  return fmt::format(
      ":root{{color-scheme:light dark;{}}}\n"
      "@media screen and (prefers-color-scheme:dark){{:root{{{}}}}}",
      variables(&Colour::light), variables(&Colour::dark));
}

std::string table_row(const std::vector<std::string>& cells) {
  std::string text = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    text += i == 0 ? fmt::format("<th scope=\"row\">{}</th>", html_escaped(cells[i]))
                   : fmt::format("<td>{}</td>", html_escaped(cells[i]));
  }
  return text + "</tr>\n";
}

}  // namespace

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string format_table(const HtmlTable& table) {
  std::string text = fmt::format("<div class=\"wide\"><table>\n<caption>{}</caption>\n<thead><tr>",
                                 html_escaped(table.caption));
  for (const std::string& cell : table.header) {
    text += fmt::format("<th scope=\"col\">{}</th>", html_escaped(cell));
  }
  text += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) text += table_row(row);
  return text + "</tbody></table></div>\n";
}

std::string format_page(std::string_view title, std::string_view body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{}</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n"
      "</html>\n",
      html_escaped(title), colour_scheme(), kStyle, body);
}

}  // namespace bess
