#include "workstation/runs/size/size_cell.h"

#include <fmt/format.h>

#include <cmath>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/report/figures/heat_map.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

std::vector<Column<SizeCell>> columns() {
  using C = SizeCell;
  return {
      {{"power_kw", "kW", "", kAllDecimals, "kW"}, [](const C& c) { return c.power_w / 1e3; }},
      {{"capacity_kwh", "kWh", "", kAllDecimals, "kWh"},
       [](const C& c) { return c.capacity_wh / 1e3; }},
      {{"contract", "contract", "", 0, "Contract"}, [](const C& c) { return c.contract->name; }},
      {{"year_eur", "EUR/year", "{:.0f}", 4, "EUR of this battery per year"}, &C::eur_per_year},
      {{"year_standard_error_by_month", "s.e.", "{:.0f}", 4, "s.e. by month, EUR/year"},
       &C::error_eur_per_year},
      {{"fixed_eur_per_year", "fixed", "{:.0f}", 4, "Fees, capacity, EUR/year"},
       &C::fixed_eur_per_year},
      {{"year_eur_per_kwh", "per kWh", "{:.1f}", 4, "EUR/year/kWh of capacity"},
       &C::eur_per_kwh_year},
      {{"cycle_eur", "per cycle", "{:.2f}", 4, "EUR per full cycle"}, &C::eur_per_cycle},
      {{"cycles_per_day", "cycles", "{:.2f}", 4, "Full cycles/day"}, &C::cycles_per_day},
      {{key::kShareOfForesight, "foresight", "{:.3f}", 4, "Share of foresight"},
       &C::share_of_foresight},
      {{"price_eur", "price", "{:.0f}", 4, "Price, EUR"}, &C::price_eur},
      {{"pay_back_years", "pay-back", "{:.1f}", 4, "Payback, years"}, &C::pay_back_years},
      {{"life_years", "life", "{:.1f}", 4, "Lifetime, years"}, &C::life_years},
      {{"life_eur", "at end", "{:.0f}", 4, "Lifetime result, EUR"}, &C::life_eur},
      {{key::kProfit, "", "{:.4f}", 4, "EUR/day/MWh of capacity, net of wear"},
       &C::profit_eur_per_day_per_mwh},
  };
}

Table table_of(const SizeReport& report) { return {columns(), report.weighed.cells}; }

std::string kilo(double value) { return fmt::format("{:g}", value / 1e3); }

std::string best_text(const SizeCells& weighed) {
  const SizeCell& best = best_of(weighed.cells);
  const std::string what =
      std::isnan(best.pay_back_years)
          ? std::string("none pays back; best lifetime result per EUR of price")
          : fmt::format("shortest payback, {:.1f} years", best.pay_back_years);
  return fmt::format("{}: {} kW, {} kWh, {}",
                     best.price_eur > 0 ? what : "highest yearly earnings per kWh",
                     kilo(best.power_w), kilo(best.capacity_wh), best.contract->name);
}

/// Heat map points of a contract.
std::vector<HeatPoint> points_of(const SizeReport& report, const SizeContract& contract,
                                 HeatValue (*value)(const SizeCell&)) {
  std::vector<HeatPoint> points;
  for (const SizeCell& cell : report.weighed.cells) {
    if (cell.contract != &contract) continue;
    points.push_back({kilo(cell.power_w), kilo(cell.capacity_wh), value(cell)});
  }
  return points;
}

std::string maps_html(const SizeReport& report) {
  std::string text;
  int number = 0;
  for (const SizeContract& contract : report.plan.contracts) {
    const auto map = [&](const char* what, HeatValue (*value)(const SizeCell&)) {
      text += heat_map_html(points_of(report, contract, value),
                            {"kW", "kWh", what, fmt::format("map-{}", ++number)});
    };
    text += fmt::format("<h2>{}</h2>\n", html_escaped(contract.name));
    map("EUR per year per kWh of capacity", [](const SizeCell& c) -> HeatValue {
      return {c.eur_per_kwh_year(), c.error_eur_per_year / (c.capacity_wh / 1e3)};
    });
    if (report.weighed.cells.front().price_eur > 0) {
      map("Payback, years", [](const SizeCell& c) -> HeatValue {  // error: first order
        return {c.pay_back_years, c.pay_back_years * c.error_eur_per_year / c.eur_per_year()};
      });
    }
  }
  return text;
}

}  // namespace

std::string format_size_table(const SizeReport& report) {
  return fmt::format("{}\n{}{}\n", report.provenance, table_of(report).text(),
                     best_text(report.weighed));
}

std::string size_csv(const SizeReport& report) { return table_of(report).csv(); }

Json size_json(const SizeReport& report) {
  const Evaluation& traded = report.weighed.classes.front().traded;
  return answer("size", {{"policy", report.plan.policy},
                         {"window_days", report.plan.window_days},
                         {"days", traded.days.size()},
                         {"months", traded.errors().months},
                         {"classes", report.weighed.classes.size()},
                         {"cells", table_of(report).json()}});
}

void write_size_page(const SizeReport& report, const std::filesystem::path& folder) {
  const Evaluation& traded = report.weighed.classes.front().traded;
  const Ageing& ageing = report.plan.ageing;
  const std::string body = fmt::format(
      "<h1>Battery size and contract</h1>\n<p>{}. {}.</p>\n<p class=\"note\">Yearly values from "
      "the {} from {} to {}; each month is traded by a policy fitted on the days before it; after "
      "the contract's costs, share, fees and capacity tariff. Ageing: {:g} % per year and {:g} % "
      "per 1000 full cycles, to {:g} % of the capacity; the margin falls with it. By month: "
      "standard error with each month as one sample. Maps: {}. {}</p>\n{}<h2>All "
      "batteries</h2>\n{}<script>\n{}</script>\n",
      html_escaped(report.provenance), html_escaped(best_text(report.weighed)),
      counted(traded.days.size(), "day"), traded.days.front().date, traded.days.back().date,
      ageing.calendar_percent_per_year, ageing.cycle_percent_per_1000, ageing.end_percent,
      kShadeMeaning, csv_link("size.csv"), maps_html(report),
      sort_table_html(sort_table("cells", "All batteries", table_of(report))),
      page_file("sort.js"));
  write_file(folder / "size.html",
             format_chart_page("Battery size and contract", body, Json::list()));
}

}  // namespace bess
