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
#include "workstation/base/palette.h"
#include "workstation/env/drawdown.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/picture_table.h"
#include "workstation/report/figures/regime_marks.h"
#include "workstation/report/report_page.h"

namespace bess {
namespace {

constexpr const char* kAllMonths = "all";
constexpr std::array kLineColours{&kMuted, &kSoft, &kDischarge, &kCharge, &kInk};

/// One policy in one month, or in all of them.
struct Row {
  std::string month;
  std::size_t days;
  double profit;
  DayErrors errors;
  PairedDifference gain;  ///< to the first policy; both 0 for itself
  double cycles_per_day;
  double at_reference_wear;  ///< of the same decisions
};

Row make_row(const std::string& month, const Evaluation& e, const Evaluation& first) {
  return {.month = month,
          .days = e.days.size(),
          .profit = e.profit_eur_per_day_per_mwh(),
          .errors = e.errors(),
          .gain = paired_difference(e, first),
          .cycles_per_day = e.cycles_per_day(),
          .at_reference_wear = e.profit_at_wear_eur_per_day_per_mwh(kReferenceWearEurPerMwh)};
}

std::vector<Row> rows_of(const WalkForward& policy, const WalkForward& first) {
  std::vector<Row> rows;
  for (std::size_t m = 0; m < policy.months.size(); ++m) {
    rows.push_back(make_row(policy.months[m], policy.by_month[m], first.by_month[m]));
  }
  rows.push_back(make_row(kAllMonths, policy.total, first.total));
  return rows;
}

std::size_t name_width(const BacktestResults& results) {
  std::size_t width = std::string("policy").size();
  for (const WalkForward& policy : results.policies) width = std::max(width, policy.name.size());
  return width;
}

/// "the 90 to 120 days before it, of 120 that were asked for": a fold takes what is there.
std::string window_text(const BacktestResults& results) {
  const auto [least, most] = std::ranges::minmax(results.fitted_days);
  const std::string days = least == most ? fmt::format("the {} days before it", most)
                                         : fmt::format("the {} to {} days before it", least, most);
  const bool is_short = least < static_cast<std::size_t>(results.window_days);
  return is_short ? fmt::format("{}, of {} that were asked for", days, results.window_days) : days;
}

std::vector<const WalkForward*> shown_in_figure(const BacktestResults& results) {
  std::vector<const WalkForward*> shown;
  for (const WalkForward& policy : results.policies) {
    if (policy.name != kForesightName) shown.push_back(&policy);
  }
  return shown;
}

std::string fall_text(double drawdown_eur_per_mwh) {
  if (drawdown_eur_per_mwh == 0) return "no day ended below an earlier one";
  return fmt::format(
      "its deepest fall, from the end of a day to that of a later one, was {:.0f} EUR "
      "per MWh",
      drawdown_eur_per_mwh);
}

std::string chart_caption(const BacktestResults& results) {
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  const auto best = std::ranges::max_element(
      shown, {}, [](const WalkForward* p) { return p->total.profit_eur_per_day_per_mwh(); });
  return fmt::format(
      "Each month was traded by what was fitted on {}, the charge carried over. {} earned most: "
      "{:.1f} EUR per day per MWh; {}.",
      window_text(results), (*best)->name, (*best)->total.profit_eur_per_day_per_mwh(),
      fall_text((*best)->drawdown_eur_per_mwh()));
}

/// What a month was fitted on and trades, where a boundary of the market lies between or in them.
std::vector<std::string> crossing_lines(const BacktestResults& results) {
  std::vector<std::string> lines;
  for (std::size_t m = 0; m < results.regimes.size(); ++m) {
    const FoldRegimes& of = results.regimes[m];
    if (!of.crosses()) continue;
    lines.push_back(fmt::format("{} crosses a boundary of the market: fitted {}; traded {}",
                                results.policies.front().months[m], regime_names(of.fitted),
                                regime_names(of.traded)));
  }
  return lines;
}

Json names_json(const std::vector<const PriceRegime*>& regimes) {
  Json names = Json::list();
  for (const PriceRegime* regime : regimes) names.add(regime->name);
  return names;
}

/// A line a policy over the traded days, EUR per MWh: what `values` makes of its cumulative profit.
template <typename Values>
Json lines_chart(const char* id, const BacktestResults& results, Values values) {
  Json labels = Json::list(), series = Json::list();
  std::vector<std::string> dates;
  for (const DayResult& day : results.policies.front().total.days) dates.push_back(day.date);
  for (const std::string& date : dates) labels.add(date);
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  for (std::size_t p = 0; p < shown.size(); ++p) {
    Json line = Json::list(), sums = Json::list();
    const std::vector<double> drawn = values(shown[p]->cumulative_eur_per_mwh());
    for (const double sum : drawn) sums.add(sum);
    line.add(shown[p]->name);
    line.add(kLineColours[p % kLineColours.size()]->name);
    line.add(std::move(sums));
    series.add(std::move(line));
  }
  Json chart = Json::object({{"id", id}, {"kind", "lines"}});
  chart.set("labels", std::move(labels));
  chart.set("marks", regime_marks(dates));
  chart.set("series", std::move(series));
  return chart;
}

HtmlTable total_table(const BacktestResults& results) {
  HtmlTable table;
  table.caption = "EUR per day per MWh of capacity, all traded days";
  table.header = {"Policy",   "Profit",        "s.e. over days", "By month",     "Gain",
                  "Its s.e.", "Gain by month", "At wear 10",     "Cycles a day", "Drawdown"};
  const WalkForward& first = results.policies.front();
  const std::string nothing = "\u2013";
  for (const WalkForward& policy : results.policies) {
    const Row row = rows_of(policy, first).back();
    const PairedDifference& gain = row.gain;
    const bool is_first = &policy == &first;
    table.rows.push_back(
        {policy.name, fmt::format("{:.1f}", row.profit), error_text(row.errors.plain, 1, nothing),
         error_text(row.errors.by_month, 1, nothing),
         is_first ? nothing : fmt::format("{:+.1f}", gain.mean),
         is_first ? nothing : error_text(gain.standard_error, 1, nothing),
         is_first ? nothing : error_text(gain.standard_error_by_month, 1, nothing),
         fmt::format("{:.1f}", row.at_reference_wear), fmt::format("{:.2f}", row.cycles_per_day),
         fmt::format("{:.0f}", policy.drawdown_eur_per_mwh())});
  }
  return table;
}

/// The same days, each from the same SoC; empty unless that was asked for.
std::string day_reset_html(const BacktestResults& results) {
  const Evaluation& first = results.policies.front().day_reset;
  if (first.days.empty()) return {};
  HtmlTable table;
  table.caption = "EUR per day per MWh, each day from the same SoC, its end given away";
  table.header = {"Policy", "Profit",   "s.e. over days", "By month",
                  "Gain",   "Its s.e.", "Gain by month"};
  for (const WalkForward& policy : results.policies) {
    const DayErrors errors = policy.day_reset.errors();
    const PairedDifference gain = paired_difference(policy.day_reset, first);
    table.rows.push_back({policy.name,
                          fmt::format("{:.1f}", policy.day_reset.profit_eur_per_day_per_mwh()),
                          error_text(errors.plain, 1), error_text(errors.by_month, 1),
                          fmt::format("{:+.1f}", gain.mean), error_text(gain.standard_error, 1),
                          error_text(gain.standard_error_by_month, 1)});
  }
  return format_table(table);
}

HtmlTable month_table(const BacktestResults& results) {
  const WalkForward& first = results.policies.front();
  HtmlTable table;
  table.caption = fmt::format("Profit by month, and the gain over {}", first.name);
  table.header = {"Policy"};
  for (const std::string& month : first.months) table.header.push_back(month);
  for (const WalkForward& policy : results.policies) {
    std::vector<std::string> cells{policy.name};
    for (const Row& row : rows_of(policy, first)) {
      if (row.month == kAllMonths) continue;
      const std::string gain =
          &policy == &first ? std::string() : fmt::format(" ({:+.0f})", row.gain.mean);
      cells.push_back(fmt::format("{:.0f}{}", row.profit, gain));
    }
    table.rows.push_back(std::move(cells));
  }
  std::vector<std::string> fitted{"fitted on days"};
  for (const std::size_t days : results.fitted_days) fitted.push_back(fmt::format("{}", days));
  table.rows.push_back(std::move(fitted));
  return table;
}

/// What is to be known of single months: those that cross, those that are not traded.
std::string months_html(const BacktestResults& results) {
  std::string text;
  for (const std::string& line : crossing_lines(results)) {
    text += fmt::format("<li>{}</li>\n", html_escaped(line));
  }
  for (const SkippedMonth& month : results.skipped) {
    text += fmt::format("<li>{} is not traded: {}</li>\n", html_escaped(month.month),
                        html_escaped(month.reason));
  }
  return text.empty() ? text : fmt::format("<ul class=\"note\">\n{}</ul>\n", text);
}

/// The same days, each from the same SoC; null unless that was asked for.
Json day_reset_json(const WalkForward& policy, const WalkForward& first) {
  if (policy.day_reset.days.empty()) return Json::null();
  const DayErrors errors = policy.day_reset.errors();
  const PairedDifference gain = paired_difference(policy.day_reset, first.day_reset);
  return Json::object({{key::kProfit, Decimals{policy.day_reset.profit_eur_per_day_per_mwh(), 4}},
                       {key::kProfitError, Decimals{errors.plain, 4}},
                       {key::kProfitErrorByMonth, Decimals{errors.by_month, 4}},
                       {key::kGain, Decimals{gain.mean, 4}},
                       {key::kGainError, Decimals{gain.standard_error, 4}},
                       {key::kGainErrorByMonth, Decimals{gain.standard_error_by_month, 4}}});
}

Json policy_json(const WalkForward& policy, const WalkForward& first) {
  const Row row = rows_of(policy, first).back();
  Json json = Json::object({{"policy", policy.name},
                            {"days", row.days},
                            {"months", policy.months.size()},
                            {key::kProfit, Decimals{row.profit, 4}},
                            {kReferenceWearKey, Decimals{row.at_reference_wear, 4}},
                            {key::kProfitError, Decimals{row.errors.plain, 4}},
                            {key::kProfitErrorByMonth, Decimals{row.errors.by_month, 4}},
                            {key::kGainOver, first.name},
                            {key::kGain, Decimals{row.gain.mean, 4}},
                            {key::kGainError, Decimals{row.gain.standard_error, 4}},
                            {key::kGainErrorByMonth, Decimals{row.gain.standard_error_by_month, 4}},
                            {"cycles_per_day", Decimals{row.cycles_per_day, 4}},
                            {"drawdown_eur_per_mwh", Decimals{policy.drawdown_eur_per_mwh(), 2}}});
  add_charge_left(policy.total.charge_left(), json);
  json.set("day_reset", day_reset_json(policy, first));
  return json;
}

/// The same days, each from the same SoC; empty unless that was asked for.
std::string day_reset_table(const BacktestResults& results, std::size_t width) {
  const Evaluation& first = results.policies.front().day_reset;
  if (first.days.empty()) return {};
  std::string text = fmt::format(
      "\nEach day starts at the same SoC and its end is given away\n"
      "{:<{}}  {:>8} {:>6} {:>8}  {:>8} {:>6} {:>8}\n",
      "policy", width, "profit", "s.e.", "by month", "gain", "s.e.", "by month");
  for (const WalkForward& policy : results.policies) {
    const DayErrors errors = policy.day_reset.errors();
    const PairedDifference gain = paired_difference(policy.day_reset, first);
    text +=
        fmt::format("{:<{}}  {:>8.1f} {:>6} {:>8}  {:>+8.1f} {:>6} {:>8}\n", policy.name, width,
                    policy.day_reset.profit_eur_per_day_per_mwh(), error_text(errors.plain, 1),
                    error_text(errors.by_month, 1), gain.mean, error_text(gain.standard_error, 1),
                    error_text(gain.standard_error_by_month, 1));
  }
  return text;
}

}  // namespace

std::string format_backtest_table(const BacktestResults& results) {
  const std::size_t width = name_width(results);
  const WalkForward& first = results.policies.front();
  std::string text = fmt::format(
      "{} months, {} days, each month by what was fitted on {}; SoC carried over;\nEUR per day per "
      "MWh of capacity\n{:<{}}  {:>8} {:>6} {:>8}  {:>8} {:>6} {:>8}  {:>10}  {:>8}  {:>8}\n",
      first.months.size(), first.total.days.size(), window_text(results), "policy", width, "profit",
      "s.e.", "by month", "gain", "s.e.", "by month", wear_column(), "cycles", "drawdown");
  for (const WalkForward& policy : results.policies) {
    const Row row = rows_of(policy, first).back();
    text += fmt::format(
        "{:<{}}  {:>8.1f} {:>6} {:>8}  {:>+8.1f} {:>6} {:>8}  {:>10.1f}  {:>8.2f}  {:>8.0f}\n",
        policy.name, width, row.profit, error_text(row.errors.plain, 1),
        error_text(row.errors.by_month, 1), row.gain.mean, error_text(row.gain.standard_error, 1),
        error_text(row.gain.standard_error_by_month, 1), row.at_reference_wear, row.cycles_per_day,
        policy.drawdown_eur_per_mwh());
  }
  text += day_reset_table(results, width);
  text += fmt::format("\nprofit by month\n{:<{}}", "policy", width);
  for (const std::string& month : first.months) text += fmt::format("  {:>8}", month);
  text += "\n";
  for (const WalkForward& policy : results.policies) {
    text += fmt::format("{:<{}}", policy.name, width);
    for (const Evaluation& month : policy.by_month) {
      text += fmt::format("  {:>8.1f}", month.profit_eur_per_day_per_mwh());
    }
    text += "\n";
  }
  text += fmt::format(
      "\ngain: day-by-day difference to {}; by month: {}\n{}\n{}: {}\n"
      "cycles: equivalent full cycles a day; drawdown: deepest fall from the end of a "
      "day to that\nof a later one, EUR per MWh\n",
      first.name, by_month_meaning(first.total.errors().months),
      charge_left_meaning(first.total.charge_price_eur_per_mwh), wear_column(),
      reference_wear_meaning(first.total.wear_eur_per_mwh));
  for (const std::string& line : crossing_lines(results)) text += line + "\n";
  for (const SkippedMonth& month : results.skipped) {
    text += fmt::format("{} is not traded: {}\n", month.month, month.reason);
  }
  return text;
}

std::string backtest_csv(const BacktestResults& results) {
  std::string text =
      "month,policy,days,profit_eur_per_day_per_mwh,gain_eur_per_day_per_mwh,"
      "gain_standard_error,profit_at_wear_10_eur_per_day_per_mwh,fitted_days,"
      "profit_standard_error,profit_standard_error_by_month,gain_standard_error_by_month,"
      "cycles_per_day\n";
  for (const WalkForward& policy : results.policies) {
    std::size_t month = 0;
    for (const Row& row : rows_of(policy, results.policies.front())) {
      const std::string fitted =
          row.month == kAllMonths ? "" : fmt::format("{}", results.fitted_days[month++]);
      text +=
          fmt::format("{},{},{},{:.4f},{:.4f},{},{:.4f},{},{},{},{},{:.4f}\n", row.month,
                      csv_field(policy.name), row.days, row.profit, row.gain.mean,
                      error_text(row.gain.standard_error, 4, ""), row.at_reference_wear, fitted,
                      error_text(row.errors.plain, 4, ""), error_text(row.errors.by_month, 4, ""),
                      error_text(row.gain.standard_error_by_month, 4, ""), row.cycles_per_day);
    }
  }
  return text;
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
  for (const WalkForward& policy : results.policies) {
    policies.add(policy_json(policy, results.policies.front()));
  }
  Json json = answer("backtest");
  json.set("window_days", results.window_days);
  json.set(key::kCarrySoc, true);
  json.set("learnt_from", results.learnt_from);
  json.set("policies", std::move(policies));
  Json months = Json::list();
  for (std::size_t m = 0; m < results.fitted_days.size(); ++m) {
    Json month = Json::object(
        {{"month", results.policies.front().months[m]}, {"fitted_days", results.fitted_days[m]}});
    if (m < results.regimes.size()) {
      month.set("regimes_fitted", names_json(results.regimes[m].fitted));
      month.set("regimes_traded", names_json(results.regimes[m].traded));
    }
    months.add(std::move(month));
  }
  json.set("months", std::move(months));
  Json skipped = Json::list();
  for (const SkippedMonth& month : results.skipped) {
    skipped.add(Json::object({{"month", month.month}, {"reason", month.reason}}));
  }
  json.set("not_traded", std::move(skipped));
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
    pictures += "<p class=\"note\">Below its peak, EUR per MWh</p>\n" +
                chart_html("falls", "How far each policy lies under its own peak");
  }
  const std::string body = fmt::format(
      "<h1>Walk-forward backtest</h1>\n<p>{}</p>\n{}\n<p class=\"note\">Gain: day by day, over {}. "
      "By month: {}. The charge is carried over; {}. At wear 10: {}. Drawdown: deepest fall from "
      "the end of a day to that of a later one, "
      "EUR per MWh.</p>\n<figure>\n<h2>Profit month after month, EUR per MWh</h2>\n{}"
      "<figcaption>{} {}</figcaption>\n</figure>\n{}\n{}",
      html_escaped(results.provenance),
      format_table(total_table(results)) + day_reset_html(results), html_escaped(first.name),
      html_escaped(by_month_meaning(first.total.errors().months)),
      charge_left_meaning(first.total.charge_price_eur_per_mwh),
      one_line(reference_wear_meaning(first.total.wear_eur_per_mwh)), pictures,
      html_escaped(with_true_minus(chart_caption(results))), csv_link("backtest_days.csv"),
      format_table(month_table(results)), months_html(results));
  write_file(folder / "backtest.html",
             format_chart_page("Walk-forward backtest", body, std::move(charts)));
}

}  // namespace bess
