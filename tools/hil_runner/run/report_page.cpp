#include "tools/hil_runner/run/report_page.h"

#include <fmt/core.h>

#include "shared/utc_text.h"
#include "tools/hil_runner/run/run_picture.h"

namespace bess {
namespace {

constexpr double kPictureMinutesMax = 2 * 1'440;  ///< of a longer run, its beginning

std::string section(const Outcome& o) {
  const char* const verdict = !o.skipped.empty() ? "skipped" : o.passed() ? "passed" : "failed";
  std::string text =
      fmt::format("<section><h2 class=\"{0}\">{1}, {2} time: {0}</h2><p>{3}</p>\n", verdict,
                  html_text(o.scenario.name), o.time(), html_text(o.scenario.title));
  if (!o.skipped.empty()) return text + "<p>" + html_text(o.skipped) + "</p></section>\n";
  if (!o.error.empty()) text += "<p>" + html_text(o.error) + "</p>\n";
  if (!o.findings.empty()) {
    text += "<div class=\"picture\"><table><tr><th>rule<th>when<th>expected<th>seen</tr>\n";
    for (const Finding& f : o.findings) {
      text += fmt::format("<tr><td>{}<td>{}<td>{}<td>{}</tr>\n", html_text(f.rule),
                          utc_text(f.utc_s).view(), html_text(f.expected), html_text(f.seen));
    }
    text += "</table></div>\n";
  }
  if (!o.evidence.minutes.empty()) {
    text += "<div class=\"picture\">" + run_picture(o, {.to_min = kPictureMinutesMax}) + "</div>\n";
    if (o.scenario.minutes > kPictureMinutesMax) text += "<p>The first two days of it.</p>\n";
  }
  return text + "</section>\n";
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  }
  return out;
}

std::string html_page(std::string_view title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title><style>"
      "body{{font:15px/1.45 Helvetica,Arial,sans-serif;max-width:920px;margin:2em auto;padding:0 "
      "12px;color:#222}}"
      "table{{border-collapse:collapse}}td,th{{padding:2px 12px 2px 0;text-align:left}}"
      ".failed{{color:#b00020}}.passed{{color:#00603a}}pre{{font-size:12px}}.picture{{overflow-x:"
      "auto}}svg{{min-width:"
      "720px;max-width:100%;height:auto}}</style></head><body>"
      "<h1>{0}</h1>\n{1}</body></html>\n",
      html_text(title), body);
}

std::string report_page(const std::vector<Outcome>& outcomes) {
  std::string body =
      "<p>Power is positive when it charges; SoC and measured power are by the battery's own "
      "record, of a real one by what it shows. Bands: faults of the battery (orange) and of the "
      "prices (grey); dashed: what happens to a "
      "process, its clock or its disk.</p>\n";
  for (const Outcome& outcome : outcomes) body += section(outcome);
  return html_page("bess-hil", body);
}

}  // namespace bess
