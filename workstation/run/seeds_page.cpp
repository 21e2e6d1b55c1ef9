#include "workstation/run/seeds_page.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/headline.h"
#include "workstation/report/judged_days.h"
#include "workstation/report/report_page.h"
#include "workstation/report/report_tables.h"
#include "workstation/report/rule_prices.h"
#include "workstation/run/run_facts.h"

namespace bess {
namespace {

constexpr const char* kTitle = "The same run from several seeds";

std::string signed_number(double value) { return fmt::format("{:+.1f}", value); }
std::string plain_number(double value) { return error_text(value, 1, "\u2013"); }

bool is_shown_band(const Band& band, std::string_view soc) {
  return band.soc == soc && !is_under_rules(band.policy);
}

std::string bands_table(const std::vector<Band>& bands, std::string_view soc,
                        const std::string& caption) {
  HtmlTable table{caption,
                  {"Policy", "Mean", "s.e. over days", "By month", "Gain", "Its s.e.",
                   "Gain by month", "s.d. over seeds", "Lowest", "Highest", "Mean at wear 10"},
                  {},
                  {}};
  for (const Band& b : bands) {
    if (!is_shown_band(b, soc)) continue;
    const auto& gain = b.gain;
    table.rows.push_back(
        {b.policy, plain_number(b.mean), plain_number(b.errors.plain),
         plain_number(b.errors.by_month), gain ? signed_number(gain->mean) : "\u2013",
         gain ? plain_number(gain->standard_error) : "\u2013",
         gain ? plain_number(gain->standard_error_by_month) : "\u2013", plain_number(b.deviation),
         plain_number(b.low), plain_number(b.high), plain_number(b.mean_at_reference_wear)});
  }
  return format_table(table);
}

std::string runs_table(const std::vector<RunSummary>& runs) {
  HtmlTable table{"The runs",
                  {"Run", "Seed", "Charge carried over", "s.e. over days", "By month",
                   "Same charge each day", "Weights", "Violations without correction"},
                  {},
                  {}};
  for (const RunSummary& run : runs) {
    const std::string name = run.folder.path.filename().string();
    const Headline headline = headline_of(run.evaluations).value();
    table.rows.push_back(
        {name, run.record.value("seed"), plain_number(headline.profit),
         plain_number(headline.errors.plain), plain_number(headline.errors.by_month),
         headline.reset_profit ? plain_number(*headline.reset_profit) : "\u2013",
         run.record.figures->weights_hash, grouped(run.record.figures->violations_plain)});
    table.links.push_back(fmt::format("{}/{}", name, run_file::kReport));
  }
  return format_table(table);
}

const Band& exported_band(const std::vector<Band>& bands) {
  return *std::ranges::find_if(
      bands, [](const Band& b) { return b.policy == kExportedPolicy && b.soc == "carried"; });
}

/// What the page is about, in a sentence.
std::string mean_text(const Band& band, std::size_t runs) {
  std::string text = fmt::format(
      "The {} earned {:.1f} EUR per day per MWh of capacity, the mean of {} seeds, charge carried "
      "over; its standard error over days is {}, and {} by month.",
      band.policy, band.mean, runs, plain_number(band.errors.plain),
      plain_number(band.errors.by_month));
  if (std::isnan(band.deviation)) return text;
  return text + fmt::format(" Seeds lie between {:.1f} and {:.1f}, their deviation is {:.1f}.",
                            band.low, band.high, band.deviation);
}

Json pair_of(double from, double to) {
  Json pair = Json::list();
  pair.add(from);
  pair.add(to);
  return pair;
}

Json named_intervals(const char* name, Json intervals) {
  Json named = Json::list();
  named.add(name);
  named.add(std::move(intervals));
  return named;
}

/// Each policy's interval over days, and the range of the seeds upon it.
Json bands_chart(const std::vector<Band>& bands) {
  Json labels = Json::list(), days = Json::list(), seeds = Json::list();
  for (const Band& b : bands) {
    if (!is_shown_band(b, "carried") || b.policy == kForesightName) continue;
    const double half = interval_half_width(b.errors, kShownCoverage);
    const double reach = std::isnan(half) ? 0 : half;
    labels.add(b.policy);
    days.add(pair_of(b.mean - reach, b.mean + reach));
    seeds.add(pair_of(b.low, b.high));
  }
  Json chart = Json::object({{"id", "bands"}, {"kind", "bands"}});
  chart.set("labels", std::move(labels));
  chart.set("thin", named_intervals("95 % over days", std::move(days)));
  chart.set("thick", named_intervals("over seeds", std::move(seeds)));
  return chart;
}

/// The exported policy, each day the mean over the runs.
Headline mean_headline(const std::vector<RunSummary>& runs) {
  std::vector<Evaluation> reset;
  std::vector<Evaluation> carried;
  for (const RunSummary& run : runs) {
    const auto exported =
        std::ranges::find(run.evaluations, kExportedPolicy, &NamedEvaluation::name);
    reset.push_back(exported->day_reset);
    carried.push_back(exported->carried_over);
  }
  return headline_of({{kExportedPolicy, mean_of(reset), mean_of(carried)}}).value();
}

std::string bands_html() {
  return "<figure>\n<h2>Bands over days and over seeds, EUR per day per MWh of capacity</h2>\n" +
         chart_html("bands",
                    "A line for each policy: the interval of its mean profit over days, and upon "
                    "it the range of the seeds") +
         "<figcaption>Thin: the interval of 95 % over days, by the wider error. Thick: from the "
         "lowest to the highest seed; a baseline knows no seed. Days are the same for all: how "
         "sure a difference between two policies is, the gain's errors below say.</figcaption>\n"
         "</figure>\n";
}

std::string unproved_html(const std::vector<UnprovedSeed>& unproved) {
  std::string text;
  for (const UnprovedSeed& seed : unproved) {
    text += fmt::format(
        "<li><a href=\"{0}/{1}\">{0}</a> was not proved, its page shows where: {2}</li>\n",
        html_escaped(seed.folder), run_file::kReport, html_escaped(seed.reason));
  }
  return text.empty() ? text : fmt::format("<ul class=\"note\">\n{}</ul>\n", text);
}

std::string facts_html(const std::filesystem::path& folder, const RunSummary& run) {
  std::vector<Fact> facts = making_facts({folder});
  facts.push_back({"program", program_text()});
  facts.push_back(
      {"prices", fmt::format("{}: {}", run.record.prices_name, run.record.value("prices"))});
  return "<h2>Where this comes from</h2>\n" + provenance_html(facts, "");
}

}  // namespace

void write_seeds_page(const std::filesystem::path& folder, const std::vector<RunSummary>& runs,
                      const std::vector<Band>& bands, const std::vector<UnprovedSeed>& unproved) {
  const Band& exported = exported_band(bands);
  const RunSummary& first = runs.front();
  const std::string body = fmt::format(
      "<h1>{}</h1>\n<section class=\"block\"><p id=\"mean\">{}</p>\n<p class=\"note\">{} {}</p>\n"
      "{}</section>\n{}<section class=\"block\">{}{}{}<p class=\"note\">Money in EUR per day per "
      "MWh of capacity. Gain: day by day, over {}. By month: {}. What differs between seeds is "
      "chance of learning; what differs between days is chance of the market: neither tells the "
      "other.</p></section>\n<section class=\"block\">{}</section>\n",
      kTitle, html_escaped(mean_text(exported, runs.size())),
      html_escaped(headline_accounting(mean_headline(runs))),
      html_escaped(judged_days_text(judged_days_of(first))), unproved_html(unproved), bands_html(),
      runs_table(runs), bands_table(bands, "carried", "Charge carried over from day to day"),
      bands_table(bands, "reset", "Each day starts at the same charge: the friendlier accounting"),
      html_escaped(first.evaluations.front().name),
      html_escaped(by_month_meaning(exported.errors.months)), facts_html(folder, first));
  Json charts = Json::list();
  charts.add(bands_chart(bands));
  write_file(folder / "seeds.html", format_chart_page(kTitle, body, std::move(charts)));
}

}  // namespace bess
