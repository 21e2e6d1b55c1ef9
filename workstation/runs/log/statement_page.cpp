#include "workstation/runs/log/statement_page.h"

#include <fmt/format.h>

#include "shared/host/text.h"

namespace bess {
namespace {

constexpr const char* kStyle =
    "body{font:11pt/1.4 sans-serif;max-width:48em;margin:2em auto;padding:0 1em;color:#111;"
    "background:#fff}table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}"
    "th,td{padding:.15em .5em;text-align:right;border-bottom:1px solid #ccc}"
    "th:first-child,td:first-child{text-align:left;white-space:nowrap}tr.sum th,tr.sum "
    "td{border-top:2px solid #111;font-weight:bold}"
    "caption{text-align:left;font-weight:bold;padding:1em 0 .3em}"
    "@media print{body{margin:0;font-size:9pt}tr{break-inside:avoid}}";

std::string table(const std::string& caption, const std::vector<std::string>& heads,
                  const std::string& rows) {
  std::string head_cells;
  for (const std::string& head : heads) head_cells += "<th scope=\"col\">" + head + "</th>";
  return "<table><caption>" + caption + "</caption>" +
         (heads.empty() ? "" : "<thead><tr>" + head_cells + "</tr></thead>") + "<tbody>\n" + rows +
         "</tbody></table>\n";
}

std::string row(const std::string& name, const std::string& cells, const char* kind = "") {
  return fmt::format("<tr{}><th scope=\"row\">{}</th>{}</tr>\n", kind, name, cells);
}

std::string day_cells(const ExchangedDay& day) {
  const QuarterHourMoney& money = day.money;
  return fmt::format(
      "<td>{:.3f}</td><td>{:.3f}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>"
      "<td>{} / {} / {}</td>",
      day.charged_wh / 1'000, day.discharged_wh / 1'000, money.earned_eur, money.contract_eur,
      money.net_eur(), money.quarter_hours, money.published, money.validated);
}

std::string notes(const ExchangedDay& all, double stored_kwh) {
  const QuarterHourMoney& money = all.money;
  std::string text = fmt::format(
      "<p>{} of {} quarter-hours have their settled price, {} of them validated; the others have "
      "the last price of their minutes",
      money.published, money.quarter_hours, money.validated);
  if (money.unpriced > 0) text += fmt::format(", and {} have none", money.unpriced);
  return text +
         fmt::format(
             ": {:.2f} EUR is an estimate. Before validation a settled price may still change. "
             "Unmetered energy (estimated from the SoC): {:.3f} kWh. Change of the stored energy: "
             "{:.3f} kWh. Taxes are included only as [costs] of the configuration contains "
             "them.</p>\n",
             money.estimated_eur, all.unseen_wh / 1'000, stored_kwh);
}

std::string contract_table(const BatteryParameters& battery) {
  const TradingCosts& costs = battery.costs;
  const auto line = [](const char* name, double value, const char* unit) {
    return row(name, fmt::format("<td>{:g} {}</td>", value, unit));
  };
  return table("Contract terms in addition to the price", {},
               line("surcharge on imports", costs.import_adder_eur_per_mwh, "EUR/MWh") +
                   line("surcharge, of the absolute price", costs.import_percent, "%") +
                   line("fee on exports", costs.export_fee_eur_per_mwh, "EUR/MWh") +
                   line("fee, of the absolute price", costs.export_percent, "%") +
                   line("wear, imports and exports", battery.wear_eur_per_mwh, "EUR/MWh"));
}

}  // namespace

std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery) {
  ExchangedDay all;
  std::map<std::string, int> stopped;
  std::string rows, stops;
  int cycles = 0, driven = 0, missing = 0;
  for (const LoggedDay& day : days) {
    rows += row(day.date, day_cells(day.exchanged));
    all.add(day.exchanged);
    cycles += day.cycles;
    driven += day.driven_cycles;
    missing += day.missing;
    for (const auto& [reason, count] : day.stopped) stopped[reason] += count;
  }
  rows += row("total", day_cells(all), " class=\"sum\"");
  for (const auto& [reason, count] : stopped) {
    stops += row(html_escaped(reason), fmt::format("<td>{}</td>", count));
  }
  const Evaluation evaluation = evaluation_of(days, battery);
  const double stored_kwh =
      (evaluation.days.back().soc_end_frac - evaluation.days.front().soc_start_frac) *
      battery.capacity_wh / 1'000;
  const std::string title = fmt::format("Battery: {} to {}", days.front().date, days.back().date);
  return fmt::format(
             "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
             "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n"
             "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n",
             title, kStyle) +
         table("By day",
               {"day", "charged kWh", "discharged kWh", "at quarter-hour prices EUR",
                "contract EUR", "net EUR", "quarter-hours / settled / validated"},
               rows) +
         notes(all, stored_kwh) + contract_table(battery) +
         fmt::format("<p>Controlled {:.1f} % of the time; {} ticks have no row in the log.</p>\n",
                     100.0 * driven / (cycles + missing), missing) +
         (stops.empty()
              ? ""
              : table("Control cycles not decided by the student", {"reason", "cycles"}, stops)) +
         "</body>\n</html>\n";
}

}  // namespace bess
