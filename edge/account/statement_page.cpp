#include "edge/account/statement_page.h"

#include "shared/host/text.h"

namespace bess {
namespace {

constexpr const char* kStyle =
    "body{font:11pt/1.4 sans-serif;max-width:48em;margin:2em auto;padding:0 1em;color:#111;"
    "background:#fff}table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}"
    "th,td{padding:.15em .5em;text-align:right;border-bottom:1px solid #ccc}"
    "th:first-child,td:first-child{text-align:left;white-space:nowrap}tr.sum th,tr.sum "
    "td{border-top:2px solid #111;"
    "font-weight:bold}caption{text-align:left;font-weight:bold;padding:1em 0 .3em}"
    "@media print{body{margin:0;font-size:9pt}tr{break-inside:avoid}}";

std::string cell(const char* format, double value) {
  std::string text = "<td>";
  add_formatted(text, format, value);
  return text + "</td>";
}

std::string money_cells(const QuarterHourMoney& money) {
  return cell("%.2f", money.earned_eur) + cell("%.2f", money.contract_eur) +
         cell("%.2f", money.net_eur()) +
         formatted("<td>%d / %d / %d</td>", money.quarter_hours, money.published, money.validated);
}

std::string days_table(const Statement& statement) {
  std::string text =
      "<table><caption>By days</caption><thead><tr><th scope=\"col\">day</th>"
      "<th scope=\"col\">charged kWh</th><th scope=\"col\">discharged kWh</th>"
      "<th scope=\"col\">by quarter-hours EUR</th><th scope=\"col\">contract EUR</th>"
      "<th scope=\"col\">net EUR</th><th scope=\"col\">quarter-hours / settled / validated</th>"
      "</tr></thead><tbody>\n";
  for (const DayAccount& day : statement.days()) {
    text += "<tr><th scope=\"row\">" + day.date() + "</th>" + cell("%.3f", day.charged_kwh()) +
            cell("%.3f", day.discharged_kwh()) + money_cells(day.money()) + "</tr>\n";
  }
  return text + "<tr class=\"sum\"><th scope=\"row\">together</th>" +
         cell("%.3f", statement.charged_kwh()) + cell("%.3f", statement.discharged_kwh()) +
         money_cells(statement.money()) + "</tr>\n</tbody></table>\n";
}

std::string contract_table(const Contract& contract) {
  const auto row = [](const char* name, double value, const char* unit) {
    return formatted("<tr><th scope=\"row\">%s</th><td>%g %s</td></tr>\n", name, value, unit);
  };
  return "<table><caption>The contract, beside the price</caption><tbody>\n" +
         row("on top of what is taken", contract.costs.import_adder_eur_per_mwh, "EUR/MWh") +
         row("and of the price's size", contract.costs.import_percent, "%") +
         row("off what is given", contract.costs.export_fee_eur_per_mwh, "EUR/MWh") +
         row("and of the price's size", contract.costs.export_percent, "%") +
         row("wear, of both", contract.wear_eur_per_mwh, "EUR/MWh") + "</tbody></table>\n";
}

std::string stops_table(const Stops& stops) {
  std::string text = formatted("<p>Driven %.1f %% of the time; %d cycles have no record.</p>\n",
                               100 * stops.driven_share(), stops.missing_cycles);
  if (stops.by_reason.empty()) return text;
  text +=
      "<table><caption>Where the student did not decide</caption><thead><tr>"
      "<th scope=\"col\">reason</th><th scope=\"col\">cycles</th><th scope=\"col\">not driven</th>"
      "<th scope=\"col\">cost EUR, an estimate</th></tr></thead><tbody>\n";
  for (const Stop& stop : stops.by_reason) {
    text += formatted("<tr><th scope=\"row\">%s</th><td>%d</td><td>%d</td>",
                      reason_name(stop.reason).data(), stop.cycles, stop.not_driven);
    text += stop.valued > 0 ? cell("%.2f", stop.cost_eur) : "<td>not known</td>";
    text += "</tr>\n";
  }
  return text + "</tbody></table>\n";
}

std::string notes(const Statement& statement) {
  const QuarterHourMoney money = statement.money();
  std::string text = formatted(
      "<p>%d of %d quarter-hours stand at their settled price, %d of those validated; the others "
      "at "
      "the last price of their minutes",
      money.published, money.quarter_hours, money.validated);
  if (money.unpriced > 0) add_formatted(text, ", and %d without any", money.unpriced);
  add_formatted(
      text,
      ": %.2f EUR is an estimate. Before validation a settled price may still change. %.3f kWh "
      "flowed while nobody looked, by the state of charge. At the end %.3f kWh "
      "more are stored than at the beginning. Taxes are in it as far as the contract's keys name "
      "them.</p>\n",
      money.estimated_eur, statement.unseen_kwh(), statement.stored_kwh());
  return text;
}

}  // namespace

std::string statement_page(const Statement& statement, const Stops& stops) {
  const std::string days =
      statement.days().front().date() + " to " + statement.days().back().date();
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
         "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"/>\n"
         "<title>Battery: " +
         days + "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<h1>Battery: " + days +
         "</h1>\n" + days_table(statement) + notes(statement) +
         contract_table(statement.contract()) + stops_table(stops) + "</body>\n</html>\n";
}

}  // namespace bess
