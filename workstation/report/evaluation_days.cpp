#include "workstation/report/evaluation_days.h"

#include <fmt/core.h>

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "workstation/base/answer.h"

namespace bess {
namespace {

/// soc and soc_end are names of before schema version 1, until the next release; so is what a run of then has.
constexpr std::string_view kHeaderBefore =
    "policy,soc,date,profit_eur,cycles,switches,soc_end,throughput_mwh";
constexpr std::string_view kHeader =
    "policy,soc,date,profit_eur,cycles,switches,soc_end,throughput_mwh,carry_soc,soc_end_frac";
constexpr std::string_view kReset = "reset";
constexpr std::string_view kCarried = "carried";

void add_days(std::string& text, const std::string& policy, std::string_view soc,
              const Evaluation& evaluation) {
  for (const DayResult& d : evaluation.days) {
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(policy), soc, d.date,
                        d.profit_eur, d.cycles, d.switches, d.soc_end_frac, d.throughput_mwh,
                        truth(soc == kCarried), d.soc_end_frac);
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
  const CsvTable table(text, name, csv_header(text) == kHeaderBefore ? kHeaderBefore : kHeader);
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
    (soc == kReset ? named.day_reset : named.carried_over).days.push_back(std::move(day));
  }
  return evaluations;
}

}  // namespace bess
