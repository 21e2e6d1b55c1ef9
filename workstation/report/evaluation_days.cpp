#include "workstation/report/evaluation_days.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/base/answer.h"

namespace bess {
namespace {

/// soc and soc_end are names of before schema version 1, until the next release.
constexpr std::string_view kHeader =
    "policy,soc,date,profit_eur,cycles,switches,soc_end,throughput_mwh,carry_soc,soc_end_frac,"
    "soc_start_frac,charge_value_eur,charge_price_eur_per_mwh";
/// Of a bess-train that did not value the charge that is left at the end.
constexpr std::string_view kHeaderBefore = kHeader.substr(0, kHeader.find(",carry_soc"));
constexpr std::string_view kReset = "reset";
constexpr std::string_view kCarried = "carried";

void add_days(std::string& text, const std::string& policy, std::string_view soc,
              const Evaluation& evaluation) {
  const std::string price =
      evaluation.values_charge_left() ? fmt::format("{}", evaluation.charge_price_eur_per_mwh) : "";
  for (const DayResult& d : evaluation.days) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(policy), soc, d.date,
                        d.profit_eur, d.cycles, d.switches, d.soc_end_frac, d.throughput_mwh,
                        truth(soc == kCarried), d.soc_end_frac, d.soc_start_frac,
                        d.charge_value_eur, price);
  }
}

}  // namespace

std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const NamedEvaluation& named : evaluations) {
    add_days(text, named.name, kReset, named.day_reset);
    add_days(text, named.name, kCarried, named.carried_over);
  }
  return text;
}

std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery) {
  if (csv_header(text) != kHeader && csv_header(text).starts_with(kHeaderBefore)) {
    fail(
        "{}: an older bess-train made it, which did not value the charge left at the end; remove "
        "it, and 'bess-train report --run FOLDER' makes it again",
        name);
  }
  const CsvTable table(text, name, kHeader);
  Evaluation none;
  none.capacity_mwh = battery.capacity_wh / kWattsPerMegawatt;
  none.wear_eur_per_mwh = battery.wear_eur_per_mwh;
  std::vector<NamedEvaluation> evaluations;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string& policy = table.text(row, 0);
    const std::string& soc = table.text(row, 1);
    if (soc != kReset && soc != kCarried)
      fail("{}: soc \"{}\" is neither reset nor carried", name, soc);
    if (evaluations.empty() || evaluations.back().name != policy) {
      evaluations.push_back({policy, none, none});
    }
    NamedEvaluation& named = evaluations.back();
    DayResult day{};
    day.date = table.text(row, 2);
    day.profit_eur = table.number(row, 3);
    day.cycles = table.number(row, 4);
    day.switches = static_cast<int>(table.number(row, 5));
    day.soc_end_frac = table.number(row, 6);
    day.throughput_mwh = table.number(row, 7);
    day.soc_start_frac = table.number(row, 10);
    day.charge_value_eur = table.number(row, 11);
    Evaluation& evaluation = soc == kReset ? named.day_reset : named.carried_over;
    if (!table.text(row, 12).empty()) evaluation.charge_price_eur_per_mwh = table.number(row, 12);
    evaluation.days.push_back(std::move(day));
  }
  return evaluations;
}

}  // namespace bess
