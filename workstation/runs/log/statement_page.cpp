#include <fmt/format.h>

#include "workstation/report/figures/html.h"
#include "workstation/runs/log/log_input.h"

namespace bess {
namespace {

std::vector<std::string> day_row(const std::string& name, const ExchangedDay& day) {
  const QuarterHourMoney& money = day.money;
  return {name,
          fmt::format("{:.3f}", day.charged_wh / 1'000),
          fmt::format("{:.3f}", day.discharged_wh / 1'000),
          fmt::format("{:.2f}", money.earned_eur),
          fmt::format("{:.2f}", money.contract_eur),
          fmt::format("{:.2f}", money.net_eur()),
          fmt::format("{} / {} / {}", money.quarter_hours, money.published, money.validated)};
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
  const auto eur = [](double value) { return fmt::format("{:g} EUR per MWh traded", value); };
  const auto percent = [](double value) { return fmt::format("{:g} %", value); };
  return format_table({"Contract terms in addition to the price",
                       {"Term", "Value"},
                       {{"surcharge on imports", eur(costs.import_adder_eur_per_mwh)},
                        {"surcharge, of the absolute price", percent(costs.import_percent)},
                        {"fee on exports", eur(costs.export_fee_eur_per_mwh)},
                        {"fee, of the absolute price", percent(costs.export_percent)},
                        {"wear, imports and exports", eur(battery.wear_eur_per_mwh)}}});
}

}  // namespace

std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery) {
  ExchangedDay all;
  std::map<std::string, int> stopped;
  HtmlTable table{"This battery by day",
                  {"Day", "Charged, kWh", "Discharged, kWh", "At quarter-hour prices, EUR",
                   "Contract, EUR", "Net, EUR", "Quarter-hours / settled / validated"},
                  {}};
  HtmlTable stops{"Control cycles not decided by the student", {"Reason", "Cycles"}, {}};
  int cycles = 0, driven = 0, missing = 0;
  for (const LoggedDay& day : days) {
    table.rows.push_back(day_row(day.date, day.exchanged));
    all.add(day.exchanged);
    cycles += day.cycles;
    driven += day.driven_cycles;
    missing += day.missing;
    for (const auto& [reason, count] : day.stopped) stopped[reason] += count;
  }
  table.rows.push_back(day_row("total", all));
  for (const auto& [reason, count] : stopped) {
    stops.rows.push_back({reason, fmt::format("{}", count)});
  }
  const Evaluation evaluation = evaluation_of(days, battery);
  const double stored_kwh =
      (evaluation.days.back().soc_end_frac - evaluation.days.front().soc_start_frac) *
      battery.capacity_wh / 1'000;
  const std::string title = fmt::format("Battery: {} to {}", days.front().date, days.back().date);
  return format_page(
      title,
      fmt::format(
          "<h1>{}</h1>\n{}{}{}<p>Controlled {:.1f} % of the time; {} ticks have no row in the "
          "log.</p>\n{}",
          title, format_table(table), notes(all, stored_kwh), contract_table(battery),
          100.0 * driven / (cycles + missing), missing,
          stops.rows.empty() ? "" : format_table(stops)));
}

}  // namespace bess
