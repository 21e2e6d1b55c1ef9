#include "tools/hil_runner/run/report_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdint>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>
#include <utility>

#include "edge/core/control/tick.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {

std::string junit_text(const std::vector<Outcome>& outcomes) {
  pugi::xml_document document;
  pugi::xml_node suite = document.append_child("testsuite");
  const auto count = [&](auto&& counts) { return std::ranges::count_if(outcomes, counts); };
  suite.append_attribute("name") = "bess-hil";
  suite.append_attribute("tests") = static_cast<unsigned>(outcomes.size());
  suite.append_attribute("failures") =
      static_cast<unsigned>(count([](const Outcome& o) { return o.error.empty() && o.failed(); }));
  suite.append_attribute("errors") =
      static_cast<unsigned>(count([](const Outcome& o) { return !o.error.empty(); }));
  suite.append_attribute("skipped") =
      static_cast<unsigned>(count([](const Outcome& o) { return !o.skipped.empty(); }));
  for (const Outcome& outcome : outcomes) {
    pugi::xml_node test = suite.append_child("testcase");
    test.append_attribute("classname") = outcome.time();
    test.append_attribute("name") = outcome.scenario.name.c_str();
    test.append_attribute("time") = fmt::format("{:.3f}", outcome.seconds).c_str();
    if (!outcome.skipped.empty()) {
      test.append_child("skipped").append_attribute("message") = outcome.skipped.c_str();
    } else if (!outcome.error.empty()) {
      test.append_child("error").append_attribute("message") = outcome.error.c_str();
    } else if (outcome.failed()) {
      pugi::xml_node failure = test.append_child("failure");
      failure.append_attribute("message") = complaint(outcome).c_str();
      std::string all;
      for (const Finding& f : outcome.findings) {
        all += fmt::format("{}: expected {}, seen {}, at {}\n", f.rule, f.expected, f.seen,
                           utc_text(f.utc_s).view());
      }
      failure.append_child(pugi::node_pcdata).set_value(all.c_str());
    }
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

namespace {

constexpr double kShownMinutesMax = 2 * 1'440;  ///< of a longer run, its beginning

/// Faults as bands and events as lines: `add(kind, name, from_min, to_min)`.
template <typename Add>
void for_each_mark(const Scenario& scenario, const Add& add) {
  const auto add_faults = [&](std::string name, const FaultSchedule& schedule) {
    if (schedule.faults.empty()) return;
    for (const BatteryFault fault : schedule.faults) {
      name += std::string(" ") + battery_fault_name(fault);
    }
    add("battery", name, schedule.from_s / 60, schedule.to_s / 60);
  };
  for (const FaultSchedule& fault : scenario.battery_faults) {
    add_faults("battery:", fault);
  }
  add_faults("meter:", scenario.meter.fault);
  const MarketFaultSchedule& price = scenario.price_fault;
  if (price.fault != MarketFault::kNone) {
    add("prices", fmt::format("prices: {}", kMarketFaultNames[static_cast<int>(price.fault)]),
        price.from_s / 60, price.to_s / 60);
  }
  for (const MinuteSpan& gap : scenario.prices.missing) {
    add("prices", "prices: missing", gap.from_min, gap.to_min);
  }
  for (const ScenarioEvent& event : scenario.events) {
    add("event", std::string(event_name(event.kind)), event.at_min, event.at_min);
  }
}

/// Data of report.js: points are pairs of UTC seconds and value.
Json chart_data(const Outcome& o) {
  const Scenario& scenario = o.scenario;
  const double to_min = std::min(scenario.minutes, kShownMinutesMax);
  const auto utc_s_at = [&](double minute) {
    return scenario.utc_ns_at(minute) / kNanosecondsPerSecond;
  };
  const auto is_shown = [from_s = utc_s_at(-1), to_s = utc_s_at(to_min)](std::int64_t utc_s) {
    return utc_s >= from_s && utc_s <= to_s;
  };
  Json price = Json::list(), measured_w = Json::list(), soc_percent = Json::list(),
       ordered_w = Json::list(), mode = Json::list(), modes = Json::list(), marks = Json::list();
  for (std::size_t minute = 0; minute < o.prices.indicative.size(); ++minute) {
    const std::int64_t utc_s = o.prices.utc_s(minute);
    if (is_shown(utc_s)) price.add(Json::list_of(utc_s, o.prices.indicative[minute]));
  }
  for (const MinuteRecord& m : o.evidence.minutes) {
    if (!is_shown(m.minute_utc_s)) continue;
    measured_w.add(Json::list_of(m.minute_utc_s, Decimals{60 * m.energy_wh, 1}));
    soc_percent.add(Json::list_of(m.minute_utc_s + 60, Decimals{100 * m.soc_frac, 2}));
  }
  double in_force_w = 0;
  for (const DispatchEvent& event : o.evidence.orders) {
    const std::int64_t utc_s = event.utc_ns / kNanosecondsPerSecond;
    if (!is_shown(utc_s)) continue;
    const bool is_order = event.kind == DispatchEvent::Kind::kOrder;
    if (is_order) in_force_w = event.power_w;
    ordered_w.add(Json::list_of(utc_s, in_force_w));
    if (!is_order) ordered_w.add(Json::list_of(utc_s, Json::null()));  // a gap: its own mode
  }
  for (const CycleRecord& cycle : o.evidence.log) {
    if (is_shown(cycle.utc_s)) mode.add(Json::list_of(cycle.utc_s, mode_name(cycle.mode)));
  }
  for (int i = 0; i < kModeCount; ++i) modes.add(mode_name(static_cast<Mode>(i)));
  for_each_mark(scenario, [&](const char* kind, const std::string& name, double mark_from_min,
                              double mark_to_min) {
    if (mark_from_min > to_min) return;
    marks.add(Json::object({{"kind", kind},
                            {"name", name},
                            {"from_utc_s", utc_s_at(std::max(mark_from_min, 0.0))},
                            {"to_utc_s", utc_s_at(std::min(mark_to_min, to_min))}}));
  });
  return Json::object({{"from_utc_s", utc_s_at(0)},
                       {"to_utc_s", utc_s_at(to_min)},
                       {"power_w_max", scenario.battery.physics.power_w_max},
                       {"modes", std::move(modes)},
                       {"marks", std::move(marks)},
                       {"price_eur_per_mwh", std::move(price)},
                       {"ordered_w", std::move(ordered_w)},
                       {"measured_w", std::move(measured_w)},
                       {"soc_percent", std::move(soc_percent)},
                       {"mode", std::move(mode)}});
}

std::string anchor_of(const Outcome& o) { return fmt::format("{}-{}", o.time(), o.scenario.name); }

/// Counts by verdict, and links, failed runs first.
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
      "<table>\n<caption>Findings</caption>\n<thead><tr>"
      "<th scope=\"col\">rule</th><th scope=\"col\">when</th><th scope=\"col\">expected</th>"
      "<th scope=\"col\">seen</th></tr></thead>\n<tbody>\n";
  for (const Finding& f : o.findings) {
    text += fmt::format(
        "<tr><th scope=\"row\">{}</th><td data-label=\"when\"><time>{}</time></td>"
        "<td data-label=\"expected\">{}</td><td data-label=\"seen\">{}</td></tr>\n",
        html_escaped(f.rule), utc_text(f.utc_s).view(), html_escaped(with_true_minus(f.expected)),
        html_escaped(with_true_minus(f.seen)));
  }
  return text + "</tbody></table>\n";
}

std::string section(const Outcome& o) {
  const std::string anchor = html_escaped(anchor_of(o));
  std::string text = fmt::format(
      "<section id=\"{4}\"><h2 class=\"{0}\">{1}, {2} time: {0}</h2><p>{3}</p>\n", o.verdict(),
      html_escaped(o.scenario.name), o.time(), html_escaped(o.scenario.title), anchor);
  if (!o.skipped.empty()) return text + "<p>" + html_escaped(o.skipped) + "</p></section>\n";
  if (!o.error.empty()) text += "<p>" + html_escaped(o.error) + "</p>\n";
  if (!o.findings.empty()) text += findings_table(o);
  if (!o.evidence.minutes.empty()) {
    // The data hold names of the program alone: no "<" that would end the script.
    text += fmt::format(
        "<div class=\"chart\"><canvas id=\"chart-{}\" role=\"img\"></canvas>\n"
        "<script type=\"application/json\">{}</script></div>\n",
        anchor, chart_data(o).line());
    if (o.scenario.minutes > kShownMinutesMax) text += "<p>Only the first two days.</p>\n";
  }
  return text + "</section>\n";
}

}  // namespace

std::string report_page(const std::vector<Outcome>& outcomes) {
  std::string page = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>bess-hil</title>\n<style>\n{}{}</style>\n</head>\n<body>\n<main>\n"
      "<h1>bess-hil</h1>\n"
      "<p>Charging power is positive. State of charge (SoC) and measured power are from the "
      "battery's own record; for a real battery, from its registers. Bands: faults of the battery "
      "or meter (orange) and of the prices (grey). Dashed lines: events on a process, its clock "
      "or its disk.</p>\n{}",
      page_file("document.css"), page_file("report.css"), contents(outcomes));
  for (const Outcome& outcome : outcomes) page += section(outcome);
  page += "</main>\n";
  for (const char* script : {"chart.min.js", "charts.js", "report.js"}) {
    page += fmt::format("<script>\n{}</script>\n", page_file(script));
  }
  return page + "</body>\n</html>\n";
}

}  // namespace bess
