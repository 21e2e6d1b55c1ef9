#include "workstation/impact/impact_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "workstation/base/answer.h"
#include "workstation/base/palette.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/page_files.h"
#include "workstation/report/figures/picture_table.h"
#include "workstation/report/figures/sort_table.h"
#include "workstation/report/report_page.h"

namespace bess {
namespace {

constexpr std::array kLineColours{&kInk, &kCharge, &kDischarge, &kMuted, &kSoft, &kMark, &kIdle};

std::string formula_name(PriceFormula formula) {
  return std::string(kFormulaNames[static_cast<std::size_t>(formula)]);
}

Table table_of(const std::vector<ImpactRow>& rows) {
  using R = ImpactRow;
  static const std::vector<Column<R>> kColumns{
      {{"formula", "", "", 0, "Formula"}, [](const R& r) { return formula_name(r.formula); }},
      {{"fleet_mw", "", "", kAllDecimals, "MW"}, &R::fleet_mw},
      {{"variant", "", "", 0, "Variant"}, &R::variant},
      {{"eur_per_mw_day", "", "{:.1f}", 4, "EUR a MW and day"},
       [](const R& r) { return r.mean.eur_per_mw_day; }},
      {{"eur_per_mw_day_standard_error", "", "{:.1f}", 4, "s.e. over seeds"}, &R::standard_error},
      {{"overshoot_share", "", "{:.3f}", 4, "Overshoot"},
       [](const R& r) { return r.mean.overshoot_share; }},
      {{"imbalance_mw", "", "{:.1f}", 4, "Mean |SI|, MW"},
       [](const R& r) { return r.mean.imbalance_mw; }},
      {{"imbalance_alone_mw", "", "{:.1f}", 4, "Without, MW"},
       [](const R& r) { return r.mean.imbalance_alone_mw; }},
      {{"switches_per_day", "", "{:.1f}", 4, "Switches a day"},
       [](const R& r) { return r.mean.switches_per_day; }},
  };
  return {kColumns, rows};
}

const ImpactRow& row_at(const std::vector<ImpactRow>& rows, PriceFormula formula, double mw,
                        const std::string& variant) {
  return *std::ranges::find_if(rows, [&](const ImpactRow& row) {
    return row.formula == formula && row.fleet_mw == mw && row.variant == variant;
  });
}

/// Where the fleet as a whole earns most, and from where on the system would do better without it.
std::string turning_points(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                           PriceFormula formula) {
  const auto as_it_is = [&](double mw) -> const ImpactRow& {
    return row_at(rows, formula, mw, impact_variants(plan).front().name);
  };
  const auto money = [&](double mw) { return mw * as_it_is(mw).mean.eur_per_mw_day; };
  const auto imbalance = [&](double mw) { return as_it_is(mw).mean.imbalance_mw; };
  const double most = *std::ranges::max_element(plan.fleet_mw, {}, money);
  const double best = *std::ranges::min_element(plan.fleet_mw, {}, imbalance);
  std::string text =
      fmt::format("{}: earns most in all at {:g} MW; the system's imbalance is least at {:g} MW",
                  formula_name(formula), most, best);
  for (const double mw : plan.fleet_mw) {
    const ImpactFigures& figures = as_it_is(mw).mean;
    if (mw <= best || figures.imbalance_mw <= figures.imbalance_alone_mw) continue;
    return text + fmt::format(", and larger than without a fleet from {:g} MW on", mw);
  }
  return text;
}

/// Lines over the fleet's size: `value` of each of the rows that `named` tells apart.
template <typename Value>
Json lines_chart(const std::string& id, const ImpactPlan& plan,
                 const std::vector<std::string>& names, Value value) {
  Json labels = Json::list(), series = Json::list();
  for (const double mw : plan.fleet_mw) labels.add(fmt::format("{:g} MW", mw));
  for (std::size_t n = 0; n < names.size(); ++n) {
    Json line = Json::list(), values = Json::list();
    for (const double mw : plan.fleet_mw) values.add(value(n, mw));
    line.add(names[n]);
    line.add(kLineColours[n % kLineColours.size()]->name);
    line.add(std::move(values));
    series.add(std::move(line));
  }
  Json chart = Json::object({{"id", id}, {"kind", "lines"}});
  chart.set("labels", std::move(labels));
  chart.set("series", std::move(series));
  return chart;
}

std::string with_error(const ImpactRow& row) {
  const std::string error =
      std::isnan(row.standard_error) ? "" : fmt::format(" ({:.0f})", row.standard_error);
  return fmt::format("{:.0f}{}", row.mean.eur_per_mw_day, error);
}

std::string plan_text(const ImpactPlan& plan) {
  return fmt::format(
      "{} simulated markets, each {} days learnt from and {} traded; {}; spread: clocks 0 to {} "
      "min "
      "late; small steps: {:g} % of the power each two minutes",
      plan.seeds, plan.train_days, plan.test_days, fmt::join(plan.policies, " and "),
      plan.jitter_min, 100 * plan.step_share);
}

}  // namespace

std::string format_impact_table(const ImpactPlan& plan, const std::vector<ImpactRow>& rows) {
  std::string text =
      fmt::format("EUR a MW and day (standard error over seeds)\n{}\n", plan_text(plan));
  const std::vector<ImpactVariant> variants = impact_variants(plan);
  for (std::size_t f = 0; f < kFormulaNames.size(); ++f) {
    const auto formula = static_cast<PriceFormula>(f);
    text += fmt::format("\n{:<12}{:>6}", kFormulaNames[f], "MW");
    for (const ImpactVariant& variant : variants) text += fmt::format(" {:>14}", variant.name);
    text += fmt::format(" {:>10} {:>10} {:>8}\n", "overshoot", "|SI|, MW", "switches");
    for (const double mw : plan.fleet_mw) {
      text += fmt::format("{:>18g}", mw);
      for (const ImpactVariant& variant : variants) {
        text += fmt::format(" {:>14}", with_error(row_at(rows, formula, mw, variant.name)));
      }
      const ImpactFigures& figures = row_at(rows, formula, mw, variants.front().name).mean;
      text += fmt::format(" {:>8.1f} % {:>10.1f} {:>8.1f}\n", 100 * figures.overshoot_share,
                          figures.imbalance_mw, figures.switches_per_day);
    }
  }
  text += "\n";
  for (std::size_t f = 0; f < kFormulaNames.size(); ++f) {
    text += turning_points(plan, rows, static_cast<PriceFormula>(f)) + "\n";
  }
  return text + "overshoot, |SI| and switches: of the fleet as it is\n";
}

std::string impact_csv(const std::vector<ImpactRow>& rows) { return table_of(rows).csv(); }

Json impact_json(const ImpactPlan& plan, const std::vector<ImpactRow>& rows) {
  Json policies = Json::list();
  for (const std::string& policy : plan.policies) policies.add(policy);
  Json json = answer("impact");
  json.set("policies", std::move(policies));
  json.set("seeds", plan.seeds);
  json.set("train_days", plan.train_days);
  json.set("test_days", plan.test_days);
  json.set("fleets", table_of(rows).json());
  return json;
}

void write_impact_page(const ImpactPlan& plan, const std::vector<ImpactRow>& rows,
                       const std::filesystem::path& folder) {
  const std::vector<std::string> formulas(kFormulaNames.begin(), kFormulaNames.end());
  std::vector<std::string> variants;
  for (const ImpactVariant& variant : impact_variants(plan)) variants.push_back(variant.name);
  Json charts = Json::list();
  std::string body = fmt::format(
      "<h1>A fleet that moves its own price</h1>\n<p>{}.</p>\n<p class=\"note\">{}</p>\n",
      html_escaped(plan_text(plan)), csv_link("impact.csv"));
  const auto figure = [&](const std::string& title, const std::string& id, Json chart,
                          const std::string& note) {
    charts.add(std::move(chart));
    body += fmt::format("<figure>\n<h2>{}</h2>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                        html_escaped(title), chart_html(id, title), html_escaped(note));
  };
  const auto of_formula = [&](std::size_t f, double mw) -> const ImpactFigures& {
    return row_at(rows, static_cast<PriceFormula>(f), mw, variants.front()).mean;
  };
  figure("EUR a MW and day over the fleet's size", "money",
         lines_chart("money", plan, formulas,
                     [&](std::size_t f, double mw) { return of_formula(f, mw).eur_per_mw_day; }),
         "The fleet as it is, by price formula.");
  figure("The system's imbalance with the fleet, mean size, MW", "imbalance",
         lines_chart("imbalance", plan, formulas,
                     [&](std::size_t f, double mw) { return of_formula(f, mw).imbalance_mw; }),
         fmt::format("Without a fleet {:.1f} MW.", rows.front().mean.imbalance_alone_mw));
  for (std::size_t f = 0; f < formulas.size(); ++f) {
    const auto formula = static_cast<PriceFormula>(f);
    const std::string id = fmt::format("variants-{}", f + 1);
    figure(fmt::format("What saves it, formula {}", formulas[f]), id,
           lines_chart(id, plan, variants,
                       [&](std::size_t v, double mw) {
                         return row_at(rows, formula, mw, variants[v]).mean.eur_per_mw_day;
                       }),
           turning_points(plan, rows, formula) + ".");
  }
  body += fmt::format("{}<script>\n{}</script>\n",
                      sort_table_html(sort_table("rows", "Every fleet", table_of(rows))),
                      page_file("sort.js"));
  write_file(folder / "impact.html",
             format_chart_page("A fleet that moves its own price", body, std::move(charts)));
}

}  // namespace bess
