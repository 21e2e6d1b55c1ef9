#include "tools/hil_runner/run/report_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>

#include "shared/host/file.h"
#include "shared/host/gnuplot.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/base/work_folder.h"

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

constexpr std::size_t kDrawnPointsMax = 3'000;  ///< a plot is 900 pixels wide

std::string svg_of(const std::string& commands) {
  const WorkFolder folder;
  const std::string path = folder.file("picture.svg");
  draw_with_gnuplot(path, [&](const std::filesystem::path& out) {
    return fmt::format(
               "set terminal svg size 900,680 noenhanced font 'Helvetica,13'\n"
               "set output {}\nset encoding utf8\nset minussign\nset border 3\n"
               "set tics nomirror out scale 0.5\nunset key\n"
               "set grid lc rgb '#e3e6ea'\nset lmargin 10\nset rmargin 2\nset bmargin 2\n"
               "set tmargin 1\n",
               gnuplot_quoted(out.string())) +
           commands;
  });
  const std::string file = read_file(path);
  const std::size_t begin = file.find("<svg");
  if (begin == std::string::npos) return "";
  const std::size_t attributes = begin + std::string_view("<svg").size();
  return "<svg role=\"img\" aria-label=\"Price, power, state of charge and mode of the edge over "
         "the run; faults as bands\"" +
         file.substr(attributes);
}

/// `$name << EOD` with one row per point, thinned to the visible resolution.
template <typename Row>
std::string block(const char* name, std::size_t count, const Row& row) {
  std::string text = fmt::format("${} << EOD\n", name);
  const std::size_t stride = std::max<std::size_t>(1, count / kDrawnPointsMax);
  for (std::size_t i = 0; i < count; i += stride) text += row(i);
  return text + "EOD\n";
}

/// Tic distance, about four per range: 1, 2 or 5 times a power of ten.
double tic_step(double range) {
  const double rough = std::max(range, 1e-9) / 4;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10 * power;
}

class RunPicture {
 public:
  RunPicture(const Outcome& outcome, const MinuteSpan& span)
      : outcome_(outcome),
        scenario_(outcome.scenario),
        from_min_(span.from_min),
        to_min_(std::min(span.to_min, outcome.scenario.minutes)) {}

  std::string svg() const {
    const double rated_w = scenario_.battery.physics.power_w_max;
    const bool is_long = to_min_ - from_min_ > 1'440;
    std::string text = data();
    text += fmt::format(
        "set xdata time\nset timefmt '%s'\nset xrange ['{}':'{}']\n{}"
        "set multiplot layout 4,1 margins 0.10,0.975,{},0.90 spacing 0.04\nset format x ''\n"
        "set tics font ',11'\nset key at graph 1,1.02 right bottom horizontal samplen 1.5 font "
        "',11'\n",
        utc_s_of(from_min_), utc_s_of(to_min_), bands(), is_long ? 0.14 : 0.095);
    text += fmt::format(
        "{}set ylabel 'EUR/MWh' offset 1\nset ytics {}\n"
        "plot $prices using 1:2 with steps lc rgb '#333333' notitle\nunset label\n",
        names(), tic_step(price_range()));
    text += fmt::format(
        "set ylabel 'power, W'\nset yrange [{0}:{1}]\nset ytics {2}\nplot $minutes using 1:2 with "
        "fillsteps fc rgb '#f2b68c' fs solid noborder title 'measured', $orders using 1:2 with "
        "steps lw 1.5 lc rgb '#0072b2' title 'ordered, 0 W included'\n",
        -1.15 * rated_w, 1.15 * rated_w, tic_step(2 * rated_w));
    text +=
        "set ylabel 'SoC, %'\nset yrange [0:100]\nset ytics 25\nplot $minutes using "
        "1:(100*$3) with lines lw 2 lc rgb '#009e73' notitle\n";
    text += fmt::format(
        "set ylabel 'mode'\nset format x \"{}\"\nset xlabel 'UTC{}'\nset yrange "
        "[-0.5:4.5]\nset ytics ('start' 0, 'running' 1, 'holding' 2, 'safe' 3, 'stopping' 4)\n"
        "plot $modes using 1:2 with steps lw 2 lc rgb '#333333' notitle\nunset multiplot\n",
        is_long ? "%d %b\\n%H:%M" : "%H:%M",
        is_long ? "" : fmt::format(", from {}", utc_text(utc_s_of(from_min_)).view()));
    return svg_of(text);
  }

 private:
  [[nodiscard]] std::int64_t utc_s_of(double minute) const {
    return scenario_.start_utc_s + std::llround(60 * minute);
  }
  [[nodiscard]] bool is_shown(std::int64_t utc_s) const {
    return utc_s >= utc_s_of(from_min_) - 60 && utc_s <= utc_s_of(to_min_);
  }
  [[nodiscard]] std::size_t first_price() const {
    return static_cast<std::size_t>((utc_s_of(from_min_) - outcome_.prices.start_utc_s) / 60);
  }
  [[nodiscard]] std::size_t price_count() const {
    return static_cast<std::size_t>(to_min_ - from_min_);
  }

  [[nodiscard]] double price_range() const {
    double low = 0, high = 0;
    for (std::size_t i = 0; i < price_count(); ++i) {
      const double price = outcome_.prices.indicative[first_price() + i];
      if (std::isnan(price)) continue;
      low = std::min(low, price);
      high = std::max(high, price);
    }
    return high - low;
  }

  [[nodiscard]] std::string data() const {
    const Evidence& e = outcome_.evidence;
    std::string text = block("prices", price_count(), [&](std::size_t i) {
      const double price = outcome_.prices.indicative[first_price() + i];
      const std::int64_t utc_s = utc_s_of(from_min_ + static_cast<double>(i));
      return std::isnan(price) ? std::string("\n") : fmt::format("{} {}\n", utc_s, price);
    });
    text += shown("minutes", e.minutes, [](const MinuteRecord& m) {
      return fmt::format("{} {} {}\n", m.minute_utc_s, 60 * m.energy_wh, m.soc_frac);
    });
    double in_force_w = 0;
    text += shown("orders", e.orders, [&](const DispatchEvent& order) {
      const bool is_order = order.kind == DispatchEvent::Kind::kOrder;
      if (is_order) in_force_w = order.power_w;
      // An order of 0 W is a line; the battery's own mode is a gap.
      return fmt::format("{} {}\n{}", order.utc_ns / kNanosecondsPerSecond, in_force_w,
                         is_order ? "" : "\n");
    });
    text += shown("modes", e.log, [](const CycleRecord& cycle) {
      return fmt::format("{} {}\n", cycle.utc_s, static_cast<int>(cycle.mode));
    });
    return text;
  }

  static std::int64_t utc_s(const MinuteRecord& m) { return m.minute_utc_s; }
  static std::int64_t utc_s(const CycleRecord& cycle) { return cycle.utc_s; }
  static std::int64_t utc_s(const DispatchEvent& order) {
    return order.utc_ns / kNanosecondsPerSecond;
  }
  template <typename Row, typename Text>
  [[nodiscard]] std::string shown(const char* name, const std::vector<Row>& rows,
                                  const Text& text) const {
    std::vector<const Row*> inside;
    for (const Row& row : rows) {
      if (is_shown(utc_s(row))) inside.push_back(&row);
    }
    return block(name, inside.size(), [&](std::size_t i) { return text(*inside[i]); });
  }

  /// Fault or event and its span; an instant has no end.
  struct Trouble {
    MinuteSpan span;
    const char* colour;
    std::string name;
    bool is_instant = false;
  };
  [[nodiscard]] std::vector<Trouble> troubles() const {
    constexpr const char* kOfBattery = "#e69f00";
    constexpr const char* kOfPrices = "#999999";
    std::vector<Trouble> all;
    std::vector<std::pair<const char*, const FaultSchedule*>> devices;
    for (const BatteryFaultWindow& fault : scenario_.battery_faults) {
      devices.emplace_back("battery:", &fault.schedule);
    }
    devices.emplace_back("meter:", &scenario_.meter.fault.schedule);
    for (const auto& [device, schedule] : devices) {
      if (schedule->faults.empty()) continue;
      std::string names = device;
      for (const BatteryFault fault : schedule->faults) {
        names += std::string(" ") + battery_faults()[static_cast<std::size_t>(fault) - 1].name;
      }
      all.push_back({{schedule->from_s / 60, schedule->to_s / 60}, kOfBattery, names});
    }
    const PriceFaultWindow& price = scenario_.price_fault;
    if (price.fault != MarketFault::kNone) {
      all.push_back({price.span, kOfPrices,
                     fmt::format("prices: {}", kMarketFaultNames[static_cast<int>(price.fault)])});
    }
    for (const MinuteSpan& gap : scenario_.prices.missing) {
      all.push_back({gap, kOfPrices, "prices: missing"});
    }
    for (const ScenarioEvent& event : scenario_.events) {
      all.push_back(
          {{event.at_min, event.at_min}, "#cc79a7", std::string(event_name(event.does)), true});
    }
    return all;
  }

  /// Bands: battery orange, prices grey; events of processes as lines.
  [[nodiscard]] std::string bands() const {
    std::string text;
    for (const Trouble& trouble : troubles()) {
      const std::int64_t from_s = utc_s_of(std::max(trouble.span.from_min, from_min_));
      if (trouble.is_instant) {
        text += fmt::format(
            "set arrow from first '{0}', graph 0 to first '{0}', graph 1 nohead dt 2 lw 1.5 lc rgb "
            "'{1}'\n",
            from_s, trouble.colour);
      } else {
        text += fmt::format(
            "set object rect from first '{}', graph 0 to first '{}', graph 1 fc rgb '{}' fs solid "
            "0.25 noborder behind\n",
            from_s, utc_s_of(std::min(trouble.span.to_min, to_min_)), trouble.colour);
      }
    }
    return text;
  }

  /// Labels above the first panel, alternating on three lines.
  [[nodiscard]] std::string names() const {
    std::string text;
    int line = 0;
    for (const Trouble& trouble : troubles()) {
      const double from_min = std::max(trouble.span.from_min, from_min_);
      const bool is_late = from_min > from_min_ + 0.6 * (to_min_ - from_min_);
      text +=
          fmt::format("set label '{}' at first '{}', graph {} {} font ',11'\n", trouble.name,
                      utc_s_of(from_min), 1.08 + 0.13 * (line++ % 3), is_late ? "right" : "left");
    }
    return text;
  }

  const Outcome& outcome_;
  const Scenario& scenario_;
  double from_min_, to_min_;
};

}  // namespace

std::string run_picture(const Outcome& outcome, const MinuteSpan& span) {
  return RunPicture(outcome, span).svg();
}

namespace {

constexpr double kPictureMinutesMax = 2 * 1'440;  ///< longer runs show the begin

/// Colours of bess-train's pages. gnuplot draws for a white background; dark mode inverts the
/// lightness and keeps the hue.
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

/// Scrollable region for wide content, also by keyboard.
std::string scrolling(const char* what, const Outcome& o, const std::string& inside) {
  return fmt::format(
      "<div class=\"picture\" role=\"region\" tabindex=\"0\" aria-label=\"{} of {}, {} time\">"
      "{}</div>\n",
      what, html_escaped(o.scenario.name), o.time(), inside);
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
    if (o.scenario.minutes > kPictureMinutesMax) text += "<p>The first two days.</p>\n";
  }
  return text + "</section>\n";
}

}  // namespace

std::string report_page(const std::vector<Outcome>& outcomes) {
  std::string body =
      "<p>Power is positive when charging. SoC and measured power are from the battery trace, or "
      "as "
      "displayed by a real battery. Bands: faults of the battery (orange) and of the prices "
      "(grey). "
      "Dashed lines: events of a process, its clock or its disk.</p>\n";
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
