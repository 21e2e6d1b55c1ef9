#include "workstation/report/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/host/csv.h"
#include "workstation/base/answer.h"
#include "workstation/report/rule_prices.h"

namespace bess {
namespace {

const Evaluation* foresight_of(const std::vector<NamedEvaluation>& evaluations,
                               EvaluationField field, const NamedEvaluation* given) {
  const auto found = std::ranges::find(evaluations, kForesightName, &NamedEvaluation::name);
  const NamedEvaluation* bound = found == evaluations.end() ? given : &*found;
  return bound == nullptr || (bound->*field).days.empty() ? nullptr : &(bound->*field);
}

ComparisonRow make_row(const std::string& name, const Evaluation& evaluation,
                       const Evaluation& first, const Evaluation* foresight) {
  ComparisonRow row{.name = name,
                    .days = evaluation.days.size(),
                    .profit = evaluation.profit_eur_per_day_per_mwh(),
                    .errors = evaluation.errors(),
                    .charge_left = evaluation.charge_left(),
                    .profit_at_reference_wear =
                        evaluation.profit_at_wear_eur_per_day_per_mwh(kReferenceWearEurPerMwh),
                    .difference = std::nullopt,
                    .worst_day = evaluation.worst_day_eur_per_mwh(),
                    .cycles_per_day = evaluation.cycles_per_day(),
                    .switches_per_day = evaluation.switches_per_day(),
                    .soc_end_frac_mean = evaluation.soc_end_mean(),
                    .foresight_share = std::nullopt};
  if (&evaluation != &first && !first.days.empty()) {
    row.difference = paired_difference(evaluation, first);
  }
  const double bound = foresight == nullptr ? 0 : foresight->profit_eur_per_day_per_mwh();
  if (bound > 0) row.foresight_share = row.profit / bound;
  return row;
}

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr DayErrors kNoErrors{kUnknown, kUnknown, 0, 0};

std::string or_dash(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

/// A figure with both of its errors.
std::string sure_figure(const std::string& value, const DayErrors& errors) {
  return fmt::format("{:>8} {:>6} {:>8}", value, error_text(errors.plain, 1),
                     error_text(errors.by_month, 1));
}

std::string table_line(const ComparisonRow& row, std::size_t name_width) {
  const auto& difference = row.difference;
  const std::string gain = difference ? fmt::format("{:+.1f}", difference->mean) : "-";
  const std::optional<double> percent =
      row.foresight_share ? std::optional(100 * *row.foresight_share) : std::nullopt;
  return fmt::format("{:<{}}  {}  {}  {:>9.1f}  {:>6.2f}  {:>8.1f}  {:>9}  {:>10.1f}\n", row.name,
                     name_width, sure_figure(fmt::format("{:.1f}", row.profit), row.errors),
                     sure_figure(gain, difference ? difference->errors() : kNoErrors),
                     row.worst_day, row.cycles_per_day, row.switches_per_day, or_dash(percent, 1),
                     row.profit_at_reference_wear);
}

std::string table_block(const std::string& title, const std::vector<ComparisonRow>& rows) {
  std::size_t name_width = std::string("policy").size();
  for (const ComparisonRow& row : rows) name_width = std::max(name_width, row.name.size());
  std::string text = fmt::format("{}, {} day{}; EUR per day per MWh of capacity\n", title,
                                 rows.front().days, rows.front().days == 1 ? "" : "s");
  text += fmt::format(
      "{:<{}}  {:>8} {:>6} {:>8}  {:>8} {:>6} {:>8}  {:>9}  {:>6}  {:>8}  {:>9}  {:>10}\n",
      "policy", name_width, "profit", "s.e.", "by month", "gain", "s.e.", "by month", "worst day",
      "cycles", "switches", "foresight", wear_column());
  for (const ComparisonRow& row : rows) text += table_line(row, name_width);
  return text;
}

std::string csv_line(const ComparisonRow& row, const std::string& first, bool carry_soc) {
  const auto& d = row.difference;
  return fmt::format(
      "{},{},{:.4f},{},{},{:.4f},{:.4f},{:.4f},{:.4f},{},{},{},{},{},{},{},{:.5f}\n",
      csv_field(row.name), row.days, row.profit, d ? fmt::format("{:.4f}", d->mean) : "",
      d ? error_text(d->standard_error, 4, "") : "", row.worst_day, row.cycles_per_day,
      row.switches_per_day, row.profit_at_reference_wear, truth(carry_soc),
      error_text(row.errors.plain, 4, ""), error_text(row.errors.by_month, 4, ""),
      d ? csv_field(first) : "", d ? error_text(d->standard_error_by_month, 4, "") : "",
      row.errors.months, row.foresight_share ? fmt::format("{:.6f}", *row.foresight_share) : "",
      row.soc_end_frac_mean);
}

constexpr const char* kCsvHeader =
    "policy,days,profit_eur_per_day_per_mwh,gain_eur_per_day_per_mwh,gain_standard_error,"
    "worst_day_eur_per_mwh,cycles_per_day,switches_per_day,profit_at_wear_10_eur_per_day_per_mwh,"
    "carry_soc,profit_standard_error,profit_standard_error_by_month,gain_over,"
    "gain_standard_error_by_month,months,share_of_foresight,soc_end_frac_mean\n";

}  // namespace

std::vector<ComparisonRow> comparison_rows(const std::vector<NamedEvaluation>& evaluations,
                                           EvaluationField field, const NamedEvaluation* given) {
  std::vector<ComparisonRow> rows;
  if (evaluations.empty()) return rows;
  const Evaluation* foresight = foresight_of(evaluations, field, given);
  const Evaluation& first = evaluations.front().*field;
  for (const NamedEvaluation& named : evaluations) {
    if ((named.*field).days.empty()) continue;
    rows.push_back(make_row(named.name, named.*field, first, foresight));
  }
  return rows;
}

void add_charge_left(const ChargeLeft& charge, Json& json) {
  json.set("charge_price_eur_per_mwh", Decimals{charge.price_eur_per_mwh, 4});
  json.set("charge_value_eur_per_day_per_mwh", Decimals{charge.value_eur_per_day_per_mwh, 4});
}

void add_figures(const ComparisonRow& row, const std::string& first, Json& json) {
  const PairedDifference gain = row.difference.value_or(PairedDifference{kUnknown, kUnknown});
  const double share = row.foresight_share.value_or(kUnknown);
  json.set("days", row.days);
  json.set("months", row.errors.months);
  json.set(key::kProfit, Decimals{row.profit, 4});
  json.set(kReferenceWearKey, Decimals{row.profit_at_reference_wear, 4});
  json.set(key::kProfitError, Decimals{row.errors.plain, 4});
  json.set(key::kProfitErrorByMonth, Decimals{row.errors.by_month, 4});
  json.set(key::kGainOver, row.difference ? Json(first) : Json::null());
  json.set(key::kGain, Decimals{gain.mean, 4});
  json.set(key::kGainError, Decimals{gain.standard_error, 4});
  json.set(key::kGainErrorByMonth, Decimals{gain.standard_error_by_month, 4});
  json.set("worst_day_eur_per_mwh", Decimals{row.worst_day, 4});
  json.set("cycles_per_day", Decimals{row.cycles_per_day, 4});
  json.set("switches_per_day", Decimals{row.switches_per_day, 3});
  json.set(key::kShareOfForesight, Decimals{share, 5});
  json.set("soc_end_frac_mean", Decimals{row.soc_end_frac_mean, 5});
  add_charge_left(row.charge_left, json);
}

std::string format_comparison_table(const std::vector<NamedEvaluation>& evaluations,
                                    const NamedEvaluation* foresight) {
  auto reset = comparison_rows(evaluations, &NamedEvaluation::day_reset, foresight);
  auto carried = comparison_rows(evaluations, &NamedEvaluation::carried_over, foresight);
  for (auto* rows : {&reset, &carried}) {
    std::erase_if(*rows, [](const ComparisonRow& row) { return is_under_rules(row.name); });
  }
  std::string text;
  if (!carried.empty()) text += table_block("SoC carried over from day to day", carried);
  if (!reset.empty() && !carried.empty()) text += "\n";
  if (!reset.empty()) text += table_block("Each day starts at the same SoC", reset);
  if (text.empty()) return text;
  text += "\n";
  if (evaluations.size() > 1) {
    text += fmt::format(
        "gain: day-by-day difference to {}; s.e.: standard error of the mean over days;\n"
        "cycles, switches: per day; foresight: % of the perfect-foresight profit\n",
        evaluations.front().name);
  }
  text += fmt::format("by month: {}\n", by_month_meaning(months_of(evaluations)));
  text += charge_meaning(evaluations);
  text += fmt::format("{}: {}\n", wear_column(),
                      reference_wear_meaning(configured_wear_eur_per_mwh(evaluations)));
  for (const NamedEvaluation& named : evaluations) {
    if (!named.description.empty()) text += fmt::format("{}: {}\n", named.name, named.description);
  }
  return text;
}

std::string charge_left_meaning(double price_eur_per_mwh) {
  return fmt::format(
      "the charge left at the end is valued at {:.2f} EUR/MWh, the mean settled price of these "
      "days, with losses and costs",
      price_eur_per_mwh);
}

std::string charge_meaning(const std::vector<NamedEvaluation>& evaluations) {
  const Evaluation& carried = evaluations.front().carried_over;
  std::string text;
  if (!evaluations.front().day_reset.days.empty()) {
    text = "same SoC each day: the friendlier accounting, which gives the end of each day away\n";
  }
  if (!carried.values_charge_left()) return text;
  return text + "carried over: " + charge_left_meaning(carried.charge_price_eur_per_mwh) + "\n";
}

int months_of(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation& any = evaluations.front();
  return (any.day_reset.days.empty() ? any.carried_over : any.day_reset).errors().months;
}

std::string wear_column() { return fmt::format("at wear {:g}", kReferenceWearEurPerMwh); }

std::string reference_wear_meaning(double wear_eur_per_mwh) {
  return fmt::format(
      "profit of the same decisions if wear cost {:g} EUR per MWh charged or discharged;\n"
      "in all other columns it costs what is configured: {:g}",
      kReferenceWearEurPerMwh, wear_eur_per_mwh);
}

double configured_wear_eur_per_mwh(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation& any = evaluations.front();
  return (any.day_reset.days.empty() ? any.carried_over : any.day_reset).wear_eur_per_mwh;
}

std::string comparison_csv(const std::vector<NamedEvaluation>& evaluations,
                           const NamedEvaluation* foresight) {
  std::string text = kCsvHeader;
  for (const auto& row : comparison_rows(evaluations, &NamedEvaluation::day_reset, foresight)) {
    text += csv_line(row, evaluations.front().name, false);
  }
  for (const auto& row : comparison_rows(evaluations, &NamedEvaluation::carried_over, foresight)) {
    text += csv_line(row, evaluations.front().name, true);
  }
  return text;
}

}  // namespace bess
