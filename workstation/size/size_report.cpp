#include "workstation/size/size_report.h"

#include <fmt/format.h>

#include <cmath>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/report/figures/heat_map.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/page_files.h"
#include "workstation/report/figures/picture_table.h"
#include "workstation/report/figures/sort_table.h"
#include "workstation/report/report_page.h"

namespace bess {
namespace {

/// A figure of a cell, in every place where cells are shown.
struct Column {
  const char* key;    ///< in CSV and JSON
  const char* head;   ///< on the page
  const char* brief;  ///< in the terminal; null: not there
  int decimals;
  double (*value)(const SizeCell& cell);
};

constexpr Column kColumns[] = {
    {"year_eur", "EUR a year", "EUR/year", 0, [](const SizeCell& c) { return c.eur_per_year(); }},
    {"year_standard_error_by_month", "Its s.e. by month", "s.e.", 0,
     [](const SizeCell& c) { return c.error_eur_per_year; }},
    {"fixed_eur_per_year", "Fees, capacity", "fixed", 0,
     [](const SizeCell& c) { return c.fixed_eur_per_year; }},
    {"year_eur_per_kwh", "EUR a year and kWh", "per kWh", 1,
     [](const SizeCell& c) { return c.eur_per_kwh_year(); }},
    {"cycle_eur", "EUR a full cycle", "a cycle", 2,
     [](const SizeCell& c) { return c.eur_per_cycle(); }},
    {"cycles_per_day", "Cycles a day", "cycles", 2,
     [](const SizeCell& c) { return c.cycles_per_day; }},
    {key::kShareOfForesight, "Of foresight", "foresight", 3,
     [](const SizeCell& c) { return c.share_of_foresight; }},
    {"price_eur", "Price", "price", 0, [](const SizeCell& c) { return c.price_eur; }},
    {"pay_back_years", "Paid back, years", "pay-back", 1,
     [](const SizeCell& c) { return c.pay_back_years; }},
    {"life_years", "Life, years", "life", 1, [](const SizeCell& c) { return c.life_years; }},
    {"life_eur", "EUR at its end", "at end", 0, [](const SizeCell& c) { return c.life_eur; }},
    {key::kProfit, "EUR/day/MWh net of wear", nullptr, 4,
     [](const SizeCell& c) { return c.profit_eur_per_day_per_mwh; }},
};

std::string kilo(double value) { return fmt::format("{:g}", value / 1e3); }

std::size_t contract_width(const SizePlan& plan) {
  std::size_t width = std::string("contract").size();
  for (const SizeContract& contract : plan.contracts) {
    width = std::max(width, contract.name.size());
  }
  return width;
}

std::string best_text(const SizeCells& weighed) {
  const SizeCell& best = best_of(weighed.cells);
  const std::string what =
      std::isnan(best.pay_back_years)
          ? std::string("nothing pays back; least bad")
          : fmt::format("pays back soonest, in {:.1f} years", best.pay_back_years);
  return fmt::format("{}: {} kW, {} kWh, {}", best.price_eur > 0 ? what : "most a year and kWh",
                     kilo(best.power_w), kilo(best.capacity_wh), best.contract->name);
}

/// A contract's cells as the heat map takes them.
std::vector<HeatPoint> points_of(const SizeReport& report, const SizeContract& contract,
                                 double (*value)(const SizeCell&)) {
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
    const auto map = [&](const char* what, double (*value)(const SizeCell&)) {
      text += heat_map_html(points_of(report, contract, value),
                            {"kW", "kWh", what, fmt::format("map-{}", ++number)});
    };
    text += fmt::format("<h2>{}</h2>\n", html_escaped(contract.name));
    map("EUR a year and kWh", [](const SizeCell& c) { return c.eur_per_kwh_year(); });
    if (report.weighed.cells.front().price_eur > 0) {
      map("Years until it has paid back", [](const SizeCell& c) { return c.pay_back_years; });
    }
  }
  return text;
}

SortTable cell_table(const SizeReport& report) {
  SortTable table{"cells", "Every battery", {"kW", "kWh", "Contract"}, {}};
  for (const Column& column : kColumns) table.header.emplace_back(column.head);
  for (const SizeCell& cell : report.weighed.cells) {
    std::vector<Cell> row{{kilo(cell.power_w), kilo(cell.power_w)},
                          {kilo(cell.capacity_wh), kilo(cell.capacity_wh)},
                          text_cell(cell.contract->name)};
    for (const Column& column : kColumns) {
      row.push_back(number_cell(column.value(cell), column.decimals));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The table's cells; the error of one month, and what is never paid back, are not known.
std::string number_or(double value, int decimals, const char* unknown) {
  return std::isnan(value) ? unknown : fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string format_size_table(const SizeReport& report) {
  const std::size_t width = contract_width(report.plan);
  std::string text =
      fmt::format("{}\n{:>8} {:>8}  {:<{}}", report.provenance, "kW", "kWh", "contract", width);
  for (const Column& column : kColumns) {
    if (column.brief != nullptr) text += fmt::format(" {:>9}", column.brief);
  }
  for (const SizeCell& cell : report.weighed.cells) {
    text += fmt::format("\n{:>8} {:>8}  {:<{}}", kilo(cell.power_w), kilo(cell.capacity_wh),
                        cell.contract->name, width);
    for (const Column& column : kColumns) {
      if (column.brief == nullptr) continue;
      text += fmt::format(" {:>9}", number_or(column.value(cell), column.decimals, "-"));
    }
  }
  return text + fmt::format("\n{}\n", best_text(report.weighed));
}

std::string size_csv(const SizeReport& report) {
  std::string text = "power_kw,capacity_kwh,contract";
  for (const Column& column : kColumns) text.append(",").append(column.key);
  for (const SizeCell& cell : report.weighed.cells) {
    text += fmt::format("\n{},{},{}", kilo(cell.power_w), kilo(cell.capacity_wh),
                        csv_field(cell.contract->name));
    for (const Column& column : kColumns) {
      text.append(",").append(number_or(column.value(cell), 4, ""));
    }
  }
  return text + "\n";
}

Json size_json(const SizeReport& report) {
  Json cells = Json::list();
  for (const SizeCell& cell : report.weighed.cells) {
    Json row = Json::object({{"power_kw", cell.power_w / 1e3},
                             {"capacity_kwh", cell.capacity_wh / 1e3},
                             {"contract", cell.contract->name}});
    for (const Column& column : kColumns) row.set(column.key, Decimals{column.value(cell), 4});
    cells.add(std::move(row));
  }
  const Evaluation& traded = report.weighed.classes.front().traded;
  Json json = answer("size");
  json.set("policy", report.plan.policy);
  json.set("window_days", report.plan.window_days);
  json.set("days", traded.days.size());
  json.set("months", traded.errors().months);
  json.set("classes", report.weighed.classes.size());
  json.set("cells", std::move(cells));
  return json;
}

void write_size_page(const SizeReport& report, const std::filesystem::path& folder) {
  const Evaluation& traded = report.weighed.classes.front().traded;
  const Ageing& ageing = report.plan.ageing;
  const std::string body = fmt::format(
      "<h1>What size, which contract</h1>\n<p>{}. {}.</p>\n<p class=\"note\">A year as the {} from "
      "{} to {} were, each month traded by what was fitted before it; after the contract's costs, "
      "share, fees and capacity tariff. Ageing: {:g} % a year and {:g} % a thousand cycles, to "
      "{:g} "
      "% of the capacity; the margin falls with it. By month: the standard error with the days of "
      "a month as one draw. {}</p>\n{}<h2>Every battery</h2>\n{}<script>\n{}</script>\n",
      html_escaped(report.provenance), html_escaped(best_text(report.weighed)),
      counted(traded.days.size(), "day"), traded.days.front().date, traded.days.back().date,
      ageing.calendar_percent_per_year, ageing.cycle_percent_per_1000, ageing.end_percent,
      csv_link("size.csv"), maps_html(report), sort_table_html(cell_table(report)),
      page_file("sort.js"));
  write_file(folder / "size.html",
             format_chart_page("What size, which contract", body, Json::list()));
}

}  // namespace bess
