#include "workstation/report/comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "shared/host/csv.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/base/answer.h"
#include "workstation/report/headline.h"

namespace bess {

namespace {

PairedDifference gain_of(const ComparisonRow& row) {
  return row.difference.value_or(PairedDifference{NAN});
}

std::string table_block(const std::string& title, const std::vector<ComparisonRow>& rows) {
  return fmt::format("{}, {}; EUR per day per MWh of capacity\n{}", title,
                     counted(rows.front().days, "day"), figures_table(rows).text());
}

/// Treatment of the final charge in both accountings, as text with line ends.
std::string charge_meaning(const NamedEvaluation& evaluations) {
  std::string text;
  if (!evaluations.day_reset.days.empty()) {
    text =
        "same SoC each day: the more favourable accounting, as the end of each day is not valued\n";
  }
  const Evaluation& carried = evaluations.carried_over;
  if (!carried.values_charge_left()) return text;
  return text + "carried over: " + charge_left_meaning(carried.charge_price_eur_per_mwh) + "\n";
}

constexpr const char* kComparisonCsvKeys =
    "policy,days,profit_eur_per_day_per_mwh,gain_eur_per_day_per_mwh,gain_standard_error,"
    "worst_day_eur_per_mwh,cycles_per_day,switches_per_day,profit_at_wear_10_eur_per_day_per_mwh,"
    "carry_soc,profit_standard_error,profit_standard_error_by_month,gain_over,"
    "gain_standard_error_by_month,months,share_of_foresight,soc_end_frac_mean";
constexpr const char* kComparisonAnswerKeys =
    "days,months,profit_eur_per_day_per_mwh,profit_at_wear_10_eur_per_day_per_mwh,"
    "profit_standard_error,profit_standard_error_by_month,gain_over,gain_eur_per_day_per_mwh,"
    "gain_standard_error,gain_standard_error_by_month,worst_day_eur_per_mwh,cycles_per_day,"
    "switches_per_day,share_of_foresight,soc_end_frac_mean,charge_price_eur_per_mwh,"
    "charge_value_eur_per_day_per_mwh";

/// Splits as in ../data/env/market_steps.cpp, in the order of Split.
struct SplitMeaning {
  const char* name;
  const char* local_days;
};
constexpr SplitMeaning kMeanings[] = {
    {"Training days", "1 to 20"},   {"Validation days", "21 to 25"},
    {"Test days", "26 to the end"}, {"Validation and test days", "21 to the end"},
    {"All days", "1 to the end"},
};

const SplitMeaning& meaning_of(Split split) { return kMeanings[static_cast<std::size_t>(split)]; }

/// On one fold every traded day is a test day.
const char* local_days_of(const JudgedDays& judged) {
  const bool is_fold = judged.split == Split::kTest &&
                       std::ranges::any_of(judged.dates, [](const std::string& date) {
                         return date.substr(8) < "26";
                       });
  return is_fold ? "1 to the end" : meaning_of(judged.split).local_days;
}

constexpr std::string_view kHeader =
    "policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,"
    "soc_start_frac,charge_value_eur,charge_price_eur_per_mwh";

void add_days(std::string& text, const std::string& policy, bool carry_soc,
              const Evaluation& evaluation) {
  const std::string price =
      evaluation.values_charge_left() ? fmt::format("{}", evaluation.charge_price_eur_per_mwh) : "";
  for (const DayResult& d : evaluation.days) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(policy), d.date,
                        d.profit_eur, d.cycles, d.switches, d.throughput_mwh, truth(carry_soc),
                        d.soc_end_frac, d.soc_start_frac, d.charge_value_eur, price);
  }
}

}  // namespace

const NamedEvaluation* find_evaluation(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name) {
  const auto found = std::ranges::find(evaluations, name, &NamedEvaluation::name);
  return found == evaluations.end() ? nullptr : &*found;
}

ComparisonRow comparison_row(const std::string& name, const Evaluation& evaluation,
                             const Evaluation* first, const Evaluation* foresight) {
  ComparisonRow row{.name = name,
                    .days = evaluation.days.size(),
                    .profit = evaluation.profit_eur_per_day_per_mwh(),
                    .errors = evaluation.errors(),
                    .charge_left = evaluation.charge_left(),
                    .profit_at_reference_wear =
                        evaluation.profit_at_wear_eur_per_day_per_mwh(kReferenceWearEurPerMwh),
                    .worst_day = evaluation.worst_day_eur_per_mwh(),
                    .cycles_per_day = evaluation.cycles_per_day(),
                    .switches_per_day = evaluation.switches_per_day(),
                    .soc_end_frac_mean = evaluation.soc_end_mean()};
  if (first != nullptr) row.difference = paired_difference(evaluation, *first);
  const double bound = foresight == nullptr ? 0 : foresight->profit_eur_per_day_per_mwh();
  if (bound > 0) row.foresight_share = row.profit / bound;
  return row;
}

std::vector<ComparisonRow> comparison_rows(const std::vector<NamedEvaluation>& evaluations,
                                           EvaluationField field, const NamedEvaluation* given) {
  std::vector<ComparisonRow> rows;
  if (evaluations.empty()) return rows;
  const NamedEvaluation* const found = find_evaluation(evaluations, kForesightName);
  const NamedEvaluation* const bound = found == nullptr ? given : found;
  const Evaluation* const foresight =
      bound == nullptr || (bound->*field).days.empty() ? nullptr : &(bound->*field);
  const Evaluation& first = evaluations.front().*field;
  for (const NamedEvaluation& named : evaluations) {
    const Evaluation& own = named.*field;
    if (own.days.empty()) continue;
    const bool has_gain = &own != &first && !first.days.empty();
    rows.push_back(comparison_row(named.name, own, has_gain ? &first : nullptr, foresight));
    rows.back().carry_soc = field == &NamedEvaluation::carried_over;
    if (has_gain) rows.back().gain_over = evaluations.front().name;
  }
  return rows;
}

Table figures_table(const std::vector<ComparisonRow>& rows) {
  using R = ComparisonRow;
  static const std::vector<Column<R>> kColumns{
      {{"policy", "policy", "", 0, "Policy"}, &R::name},
      {{"days", "", "", 0}, &R::days},
      {{"months", "", "", 0}, [](const R& r) { return r.errors.months; }},
      {{key::kCarrySoc, "", "", 0}, [](const R& r) { return truth(r.carry_soc); }},
      {{key::kProfit, "profit", "{:.1f}", 4, "Profit"}, &R::profit},
      {{key::kProfitError, "s.e.", "{:.1f}", 4, "s.e."}, [](const R& r) { return r.errors.plain; }},
      {{key::kProfitErrorByMonth, "by month", "{:.1f}", 4, "By month"},
       [](const R& r) { return r.errors.by_month; }},
      {{key::kGainOver, "", "", 0}, &R::gain_over},
      {{key::kGain, "gain", "{:+.1f}", 4, "Gain"}, [](const R& r) { return gain_of(r).mean; }},
      {{key::kGainError, "s.e.", "{:.1f}", 4, "Its s.e."},
       [](const R& r) { return gain_of(r).errors.plain; }},
      {{key::kGainErrorByMonth, "by month", "{:.1f}", 4, "Gain by month"},
       [](const R& r) { return gain_of(r).errors.by_month; }},
      {{"worst_day_eur_per_mwh", "worst day", "{:.1f}", 4, "Worst day, EUR/MWh"}, &R::worst_day},
      {{"cycles_per_day", "cycles", "{:.2f}", 4, "Cycles/day"}, &R::cycles_per_day},
      {{"switches_per_day", "switches", "{:.1f}", 4, "Switches/day"}, &R::switches_per_day},
      {{key::kShareOfForesight, "foresight", "{:.1f} %", 6, "Of foresight"},
       [](const R& r) { return r.foresight_share.value_or(NAN); }},
      {{"profit_at_wear_10_eur_per_day_per_mwh", kReferenceWearHead, "{:.1f}", 4, "At wear 10"},
       &R::profit_at_reference_wear},
      {{"soc_end_frac_mean", "", "", 5}, &R::soc_end_frac_mean},
      {{"charge_price_eur_per_mwh", "", "", 4},
       [](const R& r) { return r.charge_left.price_eur_per_mwh; }},
      {{"charge_value_eur_per_day_per_mwh", "", "", 4},
       [](const R& r) { return r.charge_left.value_eur_per_day_per_mwh; }},
  };
  return {kColumns, rows};
}

void add_figures(const ComparisonRow& row, Json& json) {
  figures_table({row}).only(kComparisonAnswerKeys).add_row(0, json);
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
        "gain: mean day-by-day difference to {}; s.e.: standard error of the mean over days;\n"
        "cycles, switches: per day; foresight: share of the perfect-foresight profit\n",
        evaluations.front().name);
  }
  const NamedEvaluation& first = evaluations.front();
  text += fmt::format("by month: {}\n", by_month_meaning(first.any().errors().months));
  text += charge_meaning(first);
  text += fmt::format("{}: {}\n", kReferenceWearHead,
                      reference_wear_meaning(first.any().wear_eur_per_mwh));
  for (const NamedEvaluation& named : evaluations) {
    if (!named.description.empty()) text += fmt::format("{}: {}\n", named.name, named.description);
  }
  return text;
}

std::string charge_left_meaning(double price_eur_per_mwh) {
  return fmt::format(
      "the final charge is valued at {:.2f} EUR/MWh, the mean settled price of these days, with "
      "losses and costs",
      price_eur_per_mwh);
}

std::string reference_wear_meaning(double wear_eur_per_mwh) {
  return fmt::format(
      "profit of the same decisions at a wear cost of {:g} EUR per MWh charged or discharged;\n"
      "other columns use the configured wear cost: {:g}",
      kReferenceWearEurPerMwh, wear_eur_per_mwh);
}

std::string comparison_csv(const std::vector<NamedEvaluation>& evaluations,
                           const NamedEvaluation* foresight) {
  auto rows = comparison_rows(evaluations, &NamedEvaluation::day_reset, foresight);
  std::ranges::move(comparison_rows(evaluations, &NamedEvaluation::carried_over, foresight),
                    std::back_inserter(rows));
  return figures_table(rows).only(kComparisonCsvKeys).csv();
}

std::size_t JudgedDays::before_last_learnt() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(dates, [&](const std::string& date) { return date < last_learnt; }));
}

std::size_t JudgedDays::months() const {
  std::set<std::string> months;
  for (const std::string& date : dates) months.insert(date.substr(0, 7));
  return months.size();
}

std::string last_learnt_day(const MarketSteps& market) {
  std::string last;
  for (const MarketDay& day : market.days) {
    if (day.split == Split::kTrain || day.split == Split::kValidation) last = day.date();
  }
  return last;
}

JudgedDays judged_days(const MarketSteps& market, Split split) {
  JudgedDays judged{split, {}, last_learnt_day(market)};
  for (const MarketDay& day : market.days_of(split)) judged.dates.push_back(day.date());
  return judged;
}

std::string judged_days_text(const JudgedDays& judged) {
  const SplitMeaning& meaning = meaning_of(judged.split);
  const std::size_t days = judged.dates.size();
  std::string text =
      fmt::format("{}: local days {} of each month, {} in {} from {} to {}.", meaning.name,
                  local_days_of(judged), counted(days, "day"), counted(judged.months(), "month"),
                  judged.dates.front(), judged.dates.back());
  if (judged.last_learnt.empty()) return text;
  const std::size_t earlier = judged.before_last_learnt();
  if (earlier == 0) {
    return text +
           fmt::format(" All of them are after the training and validation days, which end on {}.",
                       judged.last_learnt);
  }
  return text + fmt::format(
                    " Training and validation days end on {}, after {} of them: a policy trained "
                    "only on earlier days may earn less.",
                    judged.last_learnt, earlier == days ? "all" : fmt::format("{}", earlier));
}

Json judged_days_json(const JudgedDays& judged) {
  return Json::object({{"split", split_name(judged.split)},
                       {"local_days", local_days_of(judged)},
                       {"days", judged.dates.size()},
                       {"months", judged.months()},
                       {"from", judged.dates.front()},
                       {"to", judged.dates.back()},
                       {"last_learnt_day", text_or_null(judged.last_learnt)},
                       {"days_before_last_learnt",
                        value_or_null(!judged.last_learnt.empty(), judged.before_last_learnt())}});
}

std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const NamedEvaluation& named : evaluations) {
    add_days(text, named.name, false, named.day_reset);
    add_days(text, named.name, true, named.carried_over);
  }
  return text;
}

std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery) {
  const CsvTable table(text, name, kHeader);
  Evaluation none;
  none.capacity_mwh = battery.capacity_wh / kWattsPerMegawatt;
  none.wear_eur_per_mwh = battery.wear_eur_per_mwh;
  std::vector<NamedEvaluation> evaluations;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& policy = table.text(row, 0);
    const std::string& carry_soc = table.text(row, 6);
    if (carry_soc != truth(true) && carry_soc != truth(false)) {
      fail("{}:{}: carry_soc \"{}\" is neither true nor false", name, table.line(row), carry_soc);
    }
    if (evaluations.empty() || evaluations.back().name != policy) {
      evaluations.push_back({policy, none, none});
    }
    NamedEvaluation& named = evaluations.back();
    DayResult day{};
    day.date = table.text(row, 1);
    day.profit_eur = table.number(row, 2);
    day.cycles = table.number(row, 3);
    day.switches = static_cast<int>(table.number(row, 4));
    day.throughput_mwh = table.number(row, 5);
    day.soc_end_frac = table.number(row, 7);
    day.soc_start_frac = table.number(row, 8);
    day.charge_value_eur = table.number(row, 9);
    Evaluation& evaluation = carry_soc == truth(true) ? named.carried_over : named.day_reset;
    if (!table.text(row, 10).empty()) evaluation.charge_price_eur_per_mwh = table.number(row, 10);
    evaluation.days.push_back(std::move(day));
  }
  return evaluations;
}

}  // namespace bess
