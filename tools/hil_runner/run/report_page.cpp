#include "tools/hil_runner/run/report_page.h"

#include <fmt/core.h>

#include "shared/host/html_text.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/run/run_picture.h"

namespace bess {
namespace {

constexpr double kPictureMinutesMax = 2 * 1'440;  ///< of a longer run, its beginning

/// Ink and paper of bess-train's pages. gnuplot draws for white paper: on a dark screen its
/// lightness is turned round and its hues stay.
constexpr const char* kStyle =
    ":root{color-scheme:light dark;--paper:#fff;--ink:#1f2933;--grid:#dde2e6;--bad:#a3271b;"
    "--good:#00704f;--focus:#0072b2}\n"
    "@media screen and (prefers-color-scheme:dark){\n"
    ":root{--paper:#14191e;--ink:#e4e8eb;--grid:#35404a;--bad:#ff9a8d;--good:#5fd6ae;"
    "--focus:#4ea8dc}\n"
    "svg{filter:invert(.92) hue-rotate(180deg)}}\n"
    "body{font:16px/1.5 system-ui,Helvetica,Arial,sans-serif;max-width:920px;margin:2em auto;"
    "padding:0 12px;color:var(--ink);background:var(--paper);overflow-wrap:anywhere}\n"
    "table{border-collapse:collapse;overflow-wrap:normal;margin-bottom:1em}"
    "caption{text-align:left;font-weight:600}time{white-space:nowrap}\n"
    "nav ul{columns:18em;padding-left:1.2em}\n"
    "td,th{padding:2px 12px 2px 0;text-align:left;border-bottom:1px solid var(--grid)}\n"
    "tbody th{font-weight:400}.failed,.late{color:var(--bad)}.passed{color:var(--good)}\n"
    "a{color:var(--focus)}:focus-visible{outline:3px solid var(--focus);outline-offset:2px}\n"
    "pre{font-size:12px}.picture{overflow-x:auto}\n"
    "svg{display:block;min-width:720px;max-width:100%;height:auto}\n";

/// What is wider than the screen scrolls by itself, by the keyboard too.
std::string scrolling(const char* what, const Outcome& o, const std::string& inside) {
  return fmt::format(
      "<div class=\"picture\" role=\"region\" tabindex=\"0\" aria-label=\"{} of {}, {} time\">"
      "{}</div>\n",
      what, html_escaped(o.scenario.name), o.time(), inside);
}

std::string anchor_of(const Outcome& o) { return fmt::format("{}-{}", o.time(), o.scenario.name); }

/// How many passed, and a link to each: those that failed first.
std::string contents(const std::vector<Outcome>& outcomes) {
  std::string counts, links;
  for (const std::string_view verdict : {"failed", "late", "passed", "skipped"}) {
    std::size_t count = 0;
    for (const Outcome& o : outcomes) {
      if (verdict != o.verdict()) continue;
      ++count;
      links += fmt::format(
          "<li><a href=\"#{}\">{}, {} time</a>: <span class=\"{}\">{}</span></li>\n",
          html_escaped(anchor_of(o)), html_escaped(o.scenario.name), o.time(), verdict, verdict);
    }
    if (verdict == "late" && count == 0) continue;
    counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count, verdict);
  }
  return fmt::format("<nav aria-label=\"Runs\">\n<p>{}</p>\n<ul>\n{}</ul>\n</nav>\n", counts,
                     links);
}

std::string findings_table(const Outcome& o) {
  std::string text =
      "<table>\n<caption>What was not as it should be</caption>\n<thead><tr>"
      "<th scope=\"col\">rule</th><th scope=\"col\">when</th><th scope=\"col\">expected</th>"
      "<th scope=\"col\">seen</th></tr></thead>\n<tbody>\n";
  for (const Finding& f : o.findings) {
    text += fmt::format(
        "<tr><th scope=\"row\">{}</th><td><time>{}</time></td><td>{}</td><td>{}</td></tr>\n",
        html_escaped(f.rule), utc_text(f.utc_s).view(), html_escaped(with_true_minus(f.expected)),
        html_escaped(with_true_minus(f.seen)));
  }
  return scrolling("Findings", o, text + "</tbody></table>");
}

std::string section(const Outcome& o) {
  std::string text =
      fmt::format("<section id=\"{4}\"><h2 class=\"{0}\">{1}, {2} time: {0}</h2><p>{3}</p>\n",
                  o.verdict(), html_escaped(o.scenario.name), o.time(),
                  html_escaped(o.scenario.title), html_escaped(anchor_of(o)));
  if (!o.skipped.empty()) return text + "<p>" + html_escaped(o.skipped) + "</p></section>\n";
  if (!o.error.empty()) text += "<p>" + html_escaped(o.error) + "</p>\n";
  if (!o.findings.empty()) text += findings_table(o);
  if (!o.evidence.minutes.empty()) {
    text += scrolling("Picture", o, run_picture(o, {.to_min = kPictureMinutesMax}));
    if (o.scenario.minutes > kPictureMinutesMax) text += "<p>The first two days of it.</p>\n";
  }
  return text + "</section>\n";
}

}  // namespace

std::string report_page(const std::vector<Outcome>& outcomes) {
  std::string body =
      "<p>Power is positive when it charges; SoC and measured power are by the battery's own "
      "record, of a real one by what it shows. Bands: faults of the battery (orange) and of the "
      "prices (grey); dashed: what happens to a "
      "process, its clock or its disk.</p>\n";
  body += contents(outcomes);
  for (const Outcome& outcome : outcomes) body += section(outcome);
  return std::string(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
             "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
             "<title>bess-hil</title>\n<style>\n") +
         kStyle + "</style>\n</head>\n<body>\n<main>\n<h1>bess-hil</h1>\n" + body +
         "</main>\n</body>\n</html>\n";
}

}  // namespace bess
