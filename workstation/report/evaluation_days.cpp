#include "workstation/report/evaluation_days.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

#include "shared/host/csv.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/base/answer.h"

namespace bess {

namespace {

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
