#include "workstation/report/comparison_notes.h"

#include <fmt/core.h>

#include <algorithm>
#include <string_view>

#include "workstation/report/figures/html.h"
#include "workstation/report/headline.h"
#include "workstation/report/rule_prices.h"

namespace bess {
namespace {

constexpr const char* kNoFigure = "\u2013";
constexpr const char* kProgramAsTeacher = "sdp teacher";
constexpr std::string_view kTeacherEnd = " teacher";  ///< of its name, whatever its method

const NamedEvaluation* evaluation_named(const std::vector<NamedEvaluation>& evaluations,
                                        std::string_view name) {
  const auto found = std::ranges::find(evaluations, name, &NamedEvaluation::name);
  return found == evaluations.end() ? nullptr : &*found;
}

double capacity_mwh_in(const NamedEvaluation& any) {
  return (any.day_reset.days.empty() ? any.carried_over : any.day_reset).capacity_mwh;
}

/// "8 MWh", "8 kWh".
std::string capacity_text(double capacity_mwh) {
  return capacity_mwh < 1 ? fmt::format("{:g} kWh", 1'000 * capacity_mwh)
                          : fmt::format("{:g} MWh", capacity_mwh);
}

/// EUR per day of all of it.
std::string eur_per_day(const Evaluation& evaluation) {
  if (evaluation.days.empty()) return kNoFigure;
  return fmt::format("{:.{}f}", evaluation.profit_eur_per_day_per_mwh() * evaluation.capacity_mwh,
                     evaluation.capacity_mwh < 1 ? 2 : 1);
}

}  // namespace

std::string whole_battery_html(const std::vector<NamedEvaluation>& evaluations) {
  if (evaluations.empty()) return {};
  HtmlTable table{
      "The configured battery of " + capacity_text(capacity_mwh_in(evaluations.front())),
      {"Policy", "EUR/day, each day from the same charge", "EUR/day, charge carried over"},
      {}};
  for (const NamedEvaluation& named : evaluations) {
    if (is_under_rules(named.name)) continue;
    table.rows.push_back(
        {named.name, eur_per_day(named.day_reset), eur_per_day(named.carried_over)});
  }
  return format_table(table);
}

std::string whole_battery_text(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* exported = find_own_student(evaluations);
  if (exported == nullptr) return {};
  return fmt::format(
      "the configured battery of {}: the {} {} EUR a day, {} with the SoC carried over (only "
      "the ratio power_w / capacity_wh matters to the student; [battery] sets the size)\n",
      capacity_text(capacity_mwh_in(*exported)), exported->name, eur_per_day(exported->day_reset),
      eur_per_day(exported->carried_over));
}

std::string same_program_text(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* program = evaluation_named(evaluations, kProgramName);
  const auto is_teacher = [](const NamedEvaluation& e) { return e.name.ends_with(kTeacherEnd); };
  const auto teacher = std::ranges::find_if(evaluations, is_teacher);
  if (program == nullptr || teacher == evaluations.end()) return {};
  for (const auto field : {&NamedEvaluation::day_reset, &NamedEvaluation::carried_over}) {
    if (!std::ranges::equal((program->*field).days, ((*teacher).*field).days, {},
                            &DayResult::profit_eur, &DayResult::profit_eur)) {
      return {};
    }
  }
  if (teacher->name != kProgramAsTeacher) {
    return fmt::format(
        "{} and {} decide the same at every step: nothing that was learnt is shown to "
        "earn more on validation days than the program that it began as",
        kProgramName, teacher->name);
  }
  return fmt::format(
      "{} and {} are the same program, fitted on the same days: they decide the same at every step",
      kProgramName, kProgramAsTeacher);
}

}  // namespace bess
