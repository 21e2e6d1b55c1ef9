#include "workstation/report/backtest_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "workstation/base/answer.h"
#include "workstation/env/day_risk.h"
#include "workstation/report/comparison.h"
#include "workstation/report/figures/figure.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/picture_table.h"

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
  double turnover_per_day;
  double at_reference_wear;  ///< of the same decisions
};

Row make_row(const std::string& month, const Evaluation& e, const Evaluation& first) {
  return {.month = month,
          .days = e.days.size(),
          .profit = e.profit_eur_per_day_per_mwh(),
          .errors = e.errors(),
          .gain = paired_difference(e, first),
          .turnover_per_day = 2 * e.cycles_per_day(),
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

/// Labels of the first day of each month, at most a dozen of them; the panel above bears none.
std::string month_tics(const std::vector<DayResult>& days, bool labelled) {
  constexpr std::size_t kLabelsMax = 12;
  constexpr std::size_t kMonthLength = 7;  // of "2024-06"
  std::vector<std::string> firsts;
  for (const DayResult& day : days) {
    const bool is_new =
        firsts.empty() || firsts.back().substr(0, kMonthLength) != day.date.substr(0, kMonthLength);
    if (is_new) firsts.push_back(day.date);
  }
  const std::size_t stride = (firsts.size() + kLabelsMax - 1) / kLabelsMax;
  std::string tics;
  for (std::size_t m = 0; m < firsts.size(); m += stride) {
    tics += fmt::format("{}'{}' '{}'", tics.empty() ? "" : ", ",
                        labelled ? firsts[m].substr(0, kMonthLength) : "", firsts[m]);
  }
  return fmt::format("set xtics ({})\n", tics);
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

/// The colour of a policy's line, in picture and key.
const Colour& line_colour(std::size_t policy) {
  return *kLineColours[policy % kLineColours.size()];
}

/// The key as the page's own text: on a narrow screen that of the picture is cut off.
std::string legend_html(const BacktestResults& results) {
  std::string items;
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  for (std::size_t p = 0; p < shown.size(); ++p) {
    items += fmt::format("<li><i style=\"background:var(--{})\"></i>{}</li>", line_colour(p).name,
                         html_escaped(shown[p]->name));
  }
  return fmt::format("<ul class=\"legend\">{}</ul>\n", items);
}

/// Cumulative profit of every policy but the bound, above; how far each is below its peak, below,
/// unless none ever is.
Figure cumulative_figure(const BacktestResults& results) {
  const std::vector<const WalkForward*> shown = shown_in_figure(results);
  std::vector<std::string> rows;
  std::vector<std::vector<double>> sums;
  std::vector<std::vector<double>> falls;
  for (const WalkForward* policy : shown) {
    sums.push_back(policy->cumulative_eur_per_mwh());
    falls.push_back(below_peak(sums.back()));
  }
  for (std::size_t d = 0; d < shown.front()->total.days.size(); ++d) {
    std::string row = shown.front()->total.days[d].date;
    for (std::size_t p = 0; p < shown.size(); ++p) {
      row += fmt::format(" {:.3f} {:.3f}", sums[p][d] / 1000, falls[p][d]);
    }
    rows.push_back(std::move(row));
  }
  Figure figure;
  figure.name = "backtest";
  figure.title = "Profit month after month";
  figure.height_px = 560;
  figure.alt =
      "Line chart: cumulative profit of each policy over the traded days; below it, how far "
      "each lies under its own peak.";
  const auto best = std::ranges::max_element(
      shown, {}, [](const WalkForward* p) { return p->total.profit_eur_per_day_per_mwh(); });
  figure.caption = fmt::format(
      "Each month was traded by what was fitted on {}, the charge carried over. {} earned most: "
      "{:.1f} EUR per day per MWh; {}.",
      window_text(results), (*best)->name, (*best)->total.profit_eur_per_day_per_mwh(),
      fall_text((*best)->drawdown_eur_per_mwh()));
  std::vector<KeyEntry> entries;
  std::string profit_plot;
  std::string fall_plot;
  for (std::size_t p = 0; p < shown.size(); ++p) {
    const Colour& colour = line_colour(p);
    entries.push_back({shown[p]->name, colour, KeyEntry::Kind::kLine, 2.5});
    const char* separator = p == 0 ? "plot " : ", ";
    profit_plot += fmt::format("{}$days using 1:{} with lines lw 2.5 lc {}", separator, 2 + 2 * p,
                               rgb(colour));
    fall_plot += fmt::format("{}$days using 1:{} with lines lw 1.5 lc {}", separator, 3 + 2 * p,
                             rgb(colour));
  }
  const KeyRow key = key_row(figure, 100, entries);
  const std::vector<DayResult>& days = shown.front()->total.days;
  const bool any_falls = std::ranges::any_of(
      shown, [](const WalkForward* policy) { return policy->drawdown_eur_per_mwh() > 0; });
  figure.commands = data_block("days", rows) +
                    "set xdata time\nset timefmt '%Y-%m-%d'\nset multiplot\n"
                    "set lmargin at screen 0.115\nset rmargin at screen 0.96\n"
                    "set tmargin at screen 0.925\n" +
                    fmt::format("set bmargin at screen {}\n", any_falls ? 0.42 : 0.12) +
                    month_tics(days, !any_falls) + "set ylabel \"profit,\\n1000 EUR/MWh\"\n" +
                    key.set + profit_plot + "\n" + key.unset;
  if (any_falls) {
    figure.commands += "set tmargin at screen 0.36\nset bmargin at screen 0.12\n" +
                       month_tics(days, true) + "set ylabel \"below its peak,\\nEUR/MWh\"\n" +
                       fall_plot + "\n";
  }
  figure.commands += "unset multiplot\n";
  return figure;
}

/// The numbers of the figure, EUR per MWh.
PictureTable curve_table(const BacktestResults& results) {
  PictureTable table{"backtest_curve", {"date"}, {}};
  std::vector<std::vector<double>> columns;
  for (const WalkForward* policy : shown_in_figure(results)) {
    table.columns.push_back(policy->name);
    table.columns.push_back(policy->name + " below peak");
    columns.push_back(policy->cumulative_eur_per_mwh());
    columns.push_back(below_peak(columns.back()));
  }
  const std::vector<DayResult>& days = results.policies.front().total.days;
  for (std::size_t d = 0; d < days.size(); ++d) {
    std::vector<std::string> row{days[d].date};
    for (const auto& column : columns) row.push_back(exact(column[d]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// The heads are those of the page of seeds.
HtmlTable total_table(const BacktestResults& results) {
  HtmlTable table;
  table.caption = "EUR per day per MWh of capacity, all traded days";
  table.header = {"Policy",   "Profit",        "s.e. over days", "By month", "Gain",
                  "Its s.e.", "Gain by month", "At wear 10",     "Turnover", "Drawdown"};
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
         fmt::format("{:.1f}", row.at_reference_wear), fmt::format("{:.2f}", row.turnover_per_day),
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

std::string skipped_html(const BacktestResults& results) {
  std::string text;
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
                            {"cycles_per_day", Decimals{row.turnover_per_day / 2, 4}},
                            {"drawdown_eur_per_mwh", Decimals{policy.drawdown_eur_per_mwh(), 2}}});
  add_charge_left(policy.total.charge_left(), json);
  json.set("day_reset", day_reset_json(policy, first));
  // Names of before schema version 1, until the next release.
  json.set("standard_error", Decimals{row.errors.plain, 4});
  json.set("gain_to_first", Decimals{row.gain.mean, 4});
  json.set("turnover_per_day", Decimals{row.turnover_per_day, 4});
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
      "s.e.", "by month", "gain", "s.e.", "by month", wear_column(), "turnover", "drawdown");
  for (const WalkForward& policy : results.policies) {
    const Row row = rows_of(policy, first).back();
    text += fmt::format(
        "{:<{}}  {:>8.1f} {:>6} {:>8}  {:>+8.1f} {:>6} {:>8}  {:>10.1f}  {:>8.2f}  {:>8.0f}\n",
        policy.name, width, row.profit, error_text(row.errors.plain, 1),
        error_text(row.errors.by_month, 1), row.gain.mean, error_text(row.gain.standard_error, 1),
        error_text(row.gain.standard_error_by_month, 1), row.at_reference_wear,
        row.turnover_per_day, policy.drawdown_eur_per_mwh());
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
      "turnover: energy through it a day, in capacities; drawdown: deepest fall from the end of a "
      "day to that\nof a later one, EUR per MWh\n",
      first.name, by_month_meaning(first.total.errors().months),
      charge_left_meaning(first.total.charge_price_eur_per_mwh), wear_column(),
      reference_wear_meaning(first.total.wear_eur_per_mwh));
  for (const SkippedMonth& month : results.skipped) {
    text += fmt::format("{} is not traded: {}\n", month.month, month.reason);
  }
  return text;
}

std::string backtest_csv(const BacktestResults& results) {
  // standard_error and turnover_per_day are names of before schema version 1, until the next
  // release.
  std::string text =
      "month,policy,days,profit_eur_per_day_per_mwh,standard_error,gain_eur_per_day_per_mwh,"
      "gain_standard_error,turnover_per_day,profit_at_wear_10_eur_per_day_per_mwh,fitted_days,"
      "profit_standard_error,profit_standard_error_by_month,gain_standard_error_by_month,"
      "cycles_per_day\n";
  for (const WalkForward& policy : results.policies) {
    std::size_t month = 0;
    for (const Row& row : rows_of(policy, results.policies.front())) {
      const std::string fitted =
          row.month == kAllMonths ? "" : fmt::format("{}", results.fitted_days[month++]);
      const std::string error = error_text(row.errors.plain, 4, "");
      text += fmt::format(
          "{},{},{},{:.4f},{},{:.4f},{},{:.4f},{:.4f},{},{},{},{},{:.4f}\n", row.month,
          csv_field(policy.name), row.days, row.profit, error, row.gain.mean,
          error_text(row.gain.standard_error, 4, ""), row.turnover_per_day, row.at_reference_wear,
          fitted, error, error_text(row.errors.by_month, 4, ""),
          error_text(row.gain.standard_error_by_month, 4, ""), row.turnover_per_day / 2);
    }
  }
  return text;
}

std::string backtest_days_csv(const BacktestResults& results) {
  // soc_end is the name of soc_end_frac before schema version 1, until the next release.
  std::string text = "date,policy,profit_eur,cycles,switches,soc_end,soc_end_frac\n";
  for (const WalkForward& policy : results.policies) {
    for (const DayResult& d : policy.total.days) {
      text += fmt::format("{},{},{:.8g},{:.4f},{},{:.5f},{:.5f}\n", d.date, csv_field(policy.name),
                          d.profit_eur, d.cycles, d.switches, d.soc_end_frac, d.soc_end_frac);
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
  json.set("soc", "carried");  // its name before schema version 1, until the next release
  json.set("learnt_from", results.learnt_from);
  json.set("policies", std::move(policies));
  Json months = Json::list();
  for (std::size_t m = 0; m < results.fitted_days.size(); ++m) {
    months.add(Json::object(
        {{"month", results.policies.front().months[m]}, {"fitted_days", results.fitted_days[m]}}));
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
  const Figure figure = cumulative_figure(results);
  draw_figure(figure, folder);
  const PictureTable curve = curve_table(results);
  write_picture(curve, folder);
  const std::filesystem::path svg = folder / (figure.name + ".svg");
  const std::string body = fmt::format(
      "<h1>Walk-forward backtest</h1>\n<p>{}</p>\n{}\n<p class=\"note\">Gain: day by day, over {}. "
      "By month: {}. The charge is carried over; {}. At wear 10: {}. Turnover: energy through it a "
      "day, in capacities. Drawdown: deepest fall from the end of a day to that of a later one, "
      "EUR "
      "per MWh.</p>\n<figure>\n<h2>{}</h2>\n{}<div class=\"wide\">{}</div>\n"
      "<figcaption>{}</figcaption>\n</figure>\n{}\n{}",
      html_escaped(results.provenance),
      format_table(total_table(results)) + day_reset_html(results), html_escaped(first.name),
      html_escaped(by_month_meaning(first.total.errors().months)),
      charge_left_meaning(first.total.charge_price_eur_per_mwh),
      one_line(reference_wear_meaning(first.total.wear_eur_per_mwh)), html_escaped(figure.title),
      legend_html(results), inline_svg(read_file(svg), figure),
      html_escaped(with_true_minus(figure.caption)) + " " + csv_link(picture_file(curve)),
      format_table(month_table(results)), skipped_html(results));
  write_file(folder / "backtest.html", format_page("Walk-forward backtest", body));
}

}  // namespace bess
