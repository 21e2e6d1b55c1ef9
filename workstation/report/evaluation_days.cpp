#include "workstation/report/evaluation_days.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/base/answer.h"

namespace bess {
namespace {

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
      fail("{}: carry_soc \"{}\" is neither true nor false", name, carry_soc);
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
