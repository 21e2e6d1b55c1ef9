#include "workstation/report/report_page.h"

#include <fmt/core.h>

#include <span>
#include <stdexcept>

#include "workstation/report/figures/html.h"
#include "workstation/report/figures/page_files.h"

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

}  // namespace

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
  for (std::size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at)) {
    json.replace(at, 1, "\\u003c");
  }
  return json;
}

std::string format_report_page(const std::map<std::string, std::string>& parts, const Json& data) {
  std::map<std::string, std::string> all = parts;
  all["style"] = style_sheet() + std::string(page_file("report.css"));
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

}  // namespace bess
