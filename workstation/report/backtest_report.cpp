#include "workstation/report/backtest_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

constexpr const char* kAllMonths = "all";
constexpr std::array kLineColours{"muted", "soft", "discharge", "charge", "ink"};

constexpr const char* kBacktestShownKeys =
    "policy,profit_eur_per_day_per_mwh,profit_standard_error,profit_standard_error_by_month,"
    "gain_eur_per_day_per_mwh,gain_standard_error,gain_standard_error_by_month,"
    "profit_at_wear_10_eur_per_day_per_mwh,cycles_per_day,drawdown_eur_per_mwh";
constexpr const char* kBacktestAnswerKeys =
    "policy,days,profit_eur_per_day_per_mwh,profit_at_wear_10_eur_per_day_per_mwh,"
    "profit_standard_error,profit_standard_error_by_month,gain_over,gain_eur_per_day_per_mwh,"
    "gain_standard_error,gain_standard_error_by_month,cycles_per_day,drawdown_eur_per_mwh,"
    "charge_price_eur_per_mwh,charge_value_eur_per_day_per_mwh";
constexpr const char* kDayResetKeys =
    "profit_eur_per_day_per_mwh,profit_standard_error,profit_standard_error_by_month,"
    "gain_eur_per_day_per_mwh,gain_standard_error,gain_standard_error_by_month";
constexpr const char* kBacktestCsvKeys =
    "month,policy,days,profit_eur_per_day_per_mwh,gain_eur_per_day_per_mwh,gain_standard_error,"
    "profit_at_wear_10_eur_per_day_per_mwh,fitted_days,profit_standard_error,"
    "profit_standard_error_by_month,gain_standard_error_by_month,cycles_per_day";

/// Gains are over the first policy.
Table rows_of(const BacktestResults& results, Evaluation WalkForward::*days) {
  const WalkForward& first = results.policies.front();
  std::vector<ComparisonRow> rows;
  for (const WalkForward& policy : results.policies) {
    rows.push_back(comparison_row(policy.name, policy.*days, &(first.*days)));
    rows.back().gain_over = first.name;
  }
  return figures_table(rows);
}

/// Totals over all months.
Table total_table(const BacktestResults& results) {
  Table table = rows_of(results, &WalkForward::total);
  table.add<WalkForward>(
      {{"drawdown_eur_per_mwh", "drawdown", "{:.0f}", 2, "Drawdown, EUR/MWh of capacity"},
       &WalkForward::drawdown_eur_per_mwh},
      results.policies);
  return table;
}

/// Day-reset accounting; empty unless requested.
Table day_reset_table(const BacktestResults& results) {
  if (results.policies.front().day_reset.days.empty()) return {};
  return rows_of(results, &WalkForward::day_reset);
}

/// "the 90 to 120 days before it, of 120 requested": a fold uses the available days.
std::string window_text(const BacktestResults& results) {
  const auto [low, high] = std::ranges::minmax(results.months, {}, &BacktestMonth::fitted_days);
  const std::size_t least = low.fitted_days, most = high.fitted_days;
  const std::string days = least == most ? fmt::format("the {} days before it", most)
                                         : fmt::format("the {} to {} days before it", least, most);
  const bool is_short = least < static_cast<std::size_t>(results.window_days);
  return is_short ? fmt::format("{}, of {} requested", days, results.window_days) : days;
}

std::vector<const WalkForward*> shown_in_figure(const BacktestResults& results) {
  std::vector<const WalkForward*> shown;
  for (const WalkForward& policy : results.policies) {
    if (policy.name != kForesightName) shown.push_back(&policy);
  }
  return shown;
}

std::string fall_text(double drawdown_eur_per_mwh) {
  if (drawdown_eur_per_mwh == 0) return "no drawdown";
  return fmt::format("its maximum drawdown by day was {:.0f} EUR per MWh of capacity",
                     drawdown_eur_per_mwh);
}

std::string chart_caption(const BacktestResults& results) {
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  const auto best = std::ranges::max_element(
      shown, {}, [](const WalkForward* p) { return p->total.profit_eur_per_day_per_mwh(); });
  return fmt::format(
      "Each month was traded by policies fitted on {}, SoC carried over. {} earned most: "
      "{:.1f} EUR per day per MWh of capacity; {}.",
      window_text(results), (*best)->name, (*best)->total.profit_eur_per_day_per_mwh(),
      fall_text((*best)->drawdown_eur_per_mwh()));
}

/// Price regimes of months whose fold crosses a regime boundary, and months that are not traded.
std::vector<std::string> month_notes(const BacktestResults& results) {
  std::vector<std::string> notes;
  for (const auto& [month, fitted_days, of] : results.months) {
    if (!of.crosses()) continue;
    notes.push_back(fmt::format("{} crosses a price regime boundary: fitted on {}; traded in {}",
                                month, regime_names(of.fitted), regime_names(of.traded)));
  }
  for (const SkippedMonth& month : results.skipped) {
    notes.push_back(fmt::format("{} is not traded: {}", month.month, month.reason));
  }
  return notes;
}

Json names_json(const std::vector<const PriceRegime*>& regimes) {
  return Json::list_from(regimes, &PriceRegime::name);
}

/// One line per policy over the traded days: `values` of the cumulative profit, EUR per MWh.
template <typename Values>
Json lines_chart(const char* id, const BacktestResults& results, Values values) {
  Json series = Json::list();
  std::vector<std::string> dates;
  for (const DayResult& day : results.policies.front().total.days) dates.push_back(day.date);
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  for (std::size_t p = 0; p < shown.size(); ++p) {
    series.add(Json::list_of(shown[p]->name, kLineColours[p % kLineColours.size()],
                             Json::list_from(values(shown[p]->cumulative_eur_per_mwh()))));
  }
  return Json::object({{"id", id},
                       {"kind", "lines"},
                       {"y", "EUR/MWh of capacity"},
                       {"labels", Json::list_from(dates)},
                       {"marks", regime_marks(dates)},
                       {"series", std::move(series)}});
}

/// Profit by month and gain over the first policy; last row: number of training days.
Table month_table(const BacktestResults& results) {
  const WalkForward& first = results.policies.front();
  Table table;
  std::vector<std::string> cells;
  for (const WalkForward& policy : results.policies) cells.push_back(policy.name);
  cells.emplace_back("training days");
  table.add<std::string>({{"", "policy", "", 0, "Policy"}, std::identity{}}, cells);
  for (std::size_t m = 0; m < results.months.size(); ++m) {
    const auto& [name, fitted_days, regimes] = results.months[m];
    cells.clear();
    for (const WalkForward& policy : results.policies) {
      const Evaluation& month = policy.by_month[m];
      cells.push_back(fmt::format("{:.0f} ({:+.0f})", month.profit_eur_per_day_per_mwh(),
                                  paired_difference(month, first.by_month[m]).mean));
    }
    cells.push_back(fmt::format("{}", fitted_days));
    table.add<std::string>({{"", name, "", 0, name}, std::identity{}}, cells);
  }
  return table;
}

std::string day_reset_html(const BacktestResults& results) {
  const Table table = day_reset_table(results);
  if (table.size() == 0) return {};
  return format_table("Day-reset accounting: each day starts at the same SoC",
                      table.only(std::string("policy,") + kDayResetKeys));
}

std::string months_html(const BacktestResults& results) {
  std::string text;
  for (const std::string& note : month_notes(results)) {
    text += fmt::format("<li>{}</li>\n", html_escaped(note));
  }
  return text.empty() ? text : fmt::format("<ul class=\"note\">\n{}</ul>\n", text);
}

}  // namespace

std::string format_backtest_table(const BacktestResults& results) {
  const WalkForward& first = results.policies.front();
  std::string text = fmt::format(
      "{} months, {} days, each month traded by policies fitted on {};\nSoC carried over; EUR per "
      "day per MWh of capacity\n{}",
      results.months.size(), first.total.days.size(), window_text(results),
      total_table(results).only(kBacktestShownKeys).text());
  if (const Table reset = day_reset_table(results); reset.size() > 0) {
    text += "\nDay-reset accounting: each day starts at the same SoC, its end is not valued\n" +
            reset.only(std::string("policy,") + kDayResetKeys).text();
  }
  text += fmt::format("\nprofit by month (gain)\n{}", month_table(results).text());
  text += fmt::format(
      "\ngain: day-by-day difference to {}; by month: {}\n{}\n{}: {}\n"
      "cycles: full cycles per day; drawdown: maximum fall between ends of days, EUR per MWh\n",
      first.name, by_month_meaning(first.total.errors().months),
      charge_left_meaning(first.total.charge_price_eur_per_mwh), kReferenceWearHead,
      reference_wear_meaning(first.total.wear_eur_per_mwh));
  for (const std::string& note : month_notes(results)) text += note + "\n";
  return text;
}

std::string backtest_csv(const BacktestResults& results) {
  const WalkForward& first = results.policies.front();
  std::vector<ComparisonRow> rows;
  std::vector<std::string> months;
  std::vector<double> fitted;
  for (const WalkForward& policy : results.policies) {
    for (std::size_t m = 0; m < results.months.size(); ++m) {
      rows.push_back(comparison_row(policy.name, policy.by_month[m], &first.by_month[m]));
      months.push_back(results.months[m].name);
      fitted.push_back(static_cast<double>(results.months[m].fitted_days));
    }
    rows.push_back(comparison_row(policy.name, policy.total, &first.total));
    months.emplace_back(kAllMonths);
    fitted.push_back(NAN);
  }
  Table table = figures_table(rows);
  table.add<std::string>({{"month"}, std::identity{}}, months);
  table.add<double>({{"fitted_days"}, std::identity{}}, fitted);
  return table.only(kBacktestCsvKeys).csv();
}

std::string backtest_days_csv(const BacktestResults& results) {
  std::string text = "date,policy,profit_eur,cycles,switches,soc_end_frac\n";
  for (const WalkForward& policy : results.policies) {
    for (const DayResult& d : policy.total.days) {
      text += fmt::format("{},{},{:.8g},{:.4f},{},{:.5f}\n", d.date, csv_field(policy.name),
                          d.profit_eur, d.cycles, d.switches, d.soc_end_frac);
    }
  }
  return text;
}

Json backtest_json(const BacktestResults& results) {
  Json policies = Json::list();
  const Table total = total_table(results).only(kBacktestAnswerKeys);
  const Table reset = day_reset_table(results);
  for (std::size_t p = 0; p < results.policies.size(); ++p) {
    Json policy = Json::object({{"months", results.months.size()}});
    total.add_row(p, policy);
    Json day_reset = reset.size() == 0 ? Json::null() : Json::object();
    if (reset.size() > 0) reset.only(kDayResetKeys).add_row(p, day_reset);
    policy.set("day_reset", std::move(day_reset));
    policies.add(std::move(policy));
  }
  Json json = answer("backtest");
  json.set("window_days", results.window_days);
  json.set(key::kCarrySoc, true);
  json.set("learnt_from", results.learnt_from);
  json.set("policies", std::move(policies));
  json.set("months", Json::list_from(results.months, [](const BacktestMonth& month) {
             return Json::object({{"month", month.name},
                                  {"fitted_days", month.fitted_days},
                                  {"regimes_fitted", names_json(month.regimes.fitted)},
                                  {"regimes_traded", names_json(month.regimes.traded)}});
           }));
  json.set("not_traded", Json::list_from(results.skipped, [](const SkippedMonth& month) {
             return Json::object({{"month", month.month}, {"reason", month.reason}});
           }));
  return json;
}

void write_backtest_page(const BacktestResults& results, const std::filesystem::path& folder) {
  const WalkForward& first = results.policies.front();
  Json charts = Json::list();
  charts.add(lines_chart("profit", results, std::identity{}));
  std::string pictures =
      chart_html("profit", "Cumulative profit of each policy over the traded days");
  const bool any_falls = std::ranges::any_of(results.policies, [](const WalkForward& policy) {
    return policy.drawdown_eur_per_mwh() > 0;
  });
  if (any_falls) {
    charts.add(lines_chart("falls", results, below_peak));
    pictures += "<p class=\"note\">Drawdown, EUR per MWh of capacity</p>\n" +
                chart_html("falls", "Drawdown of each policy");
  }
  const std::string body = fmt::format(
      "<h1>Walk-forward backtest</h1>\n<p>{}</p>\n{}\n<p class=\"note\">Gain: day by day, over {}. "
      "By month: {}. SoC carried over; {}. At wear 10: {}. Drawdown: maximum fall between ends of "
      "days.</p>\n<figure>\n<h2>Cumulative profit, EUR per MWh of capacity</h2>\n{}"
      "<figcaption>{} {}</figcaption>\n</figure>\n{}\n{}",
      html_escaped(results.provenance),
      format_table("All traded days; EUR/day/MWh: EUR per day per MWh of capacity",
                   total_table(results).only(kBacktestShownKeys)) +
          day_reset_html(results),
      html_escaped(first.name), html_escaped(by_month_meaning(first.total.errors().months)),
      charge_left_meaning(first.total.charge_price_eur_per_mwh),
      one_line(reference_wear_meaning(first.total.wear_eur_per_mwh)), pictures,
      html_escaped(with_true_minus(chart_caption(results))), csv_link("backtest_days.csv"),
      format_table(fmt::format("Profit by month (gain over {}), EUR per day per MWh of capacity",
                               first.name),
                   month_table(results)),
      months_html(results));
  write_file(folder / "backtest.html",
             format_chart_page("Walk-forward backtest", body, std::move(charts)));
}

}  // namespace bess
