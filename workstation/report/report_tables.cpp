#include "workstation/report/report_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "shared/host/text.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/headline.h"
#include "workstation/report/page_data.h"

namespace bess {

namespace {

constexpr const char* kProgramAsTeacher = "sdp teacher";
constexpr std::string_view kTeacherEnd = " teacher";  ///< end of its name

/// "8 MWh", "8 kWh".
std::string capacity_text(double capacity_mwh) {
  return capacity_mwh < 1 ? fmt::format("{:g} kWh", 1'000 * capacity_mwh)
                          : fmt::format("{:g} MWh", capacity_mwh);
}

/// EUR per day of the whole battery.
std::string eur_per_day(const Evaluation& evaluation) {
  if (evaluation.days.empty()) return kNoValue;
  return fmt::format("{:.{}f}", evaluation.profit_eur_per_day_per_mwh() * evaluation.capacity_mwh,
                     evaluation.capacity_mwh < 1 ? 2 : 1);
}

std::string comparison_table(const std::string& caption, std::vector<ComparisonRow> rows) {
  std::erase_if(rows, [](const ComparisonRow& row) { return is_under_rules(row.name); });
  if (rows.empty()) return {};
  return format_table(fmt::format("{}, {} days, EUR/day/MWh", caption, rows.front().days),
                      figures_table(rows));
}

std::vector<std::string> proof_cells(const std::string& name, const Certificate& c) {
  return {name, grouped(c.states_checked), grouped(c.violations_of(1)), grouped(c.violations_of(2)),
          grouped(c.violations_of(3))};
}

std::string percent_broken(const DemandCount& count) {
  if (!count.binds_student || count.states == 0) return kNoValue;
  return fmt::format(
      "{:.2f}", 100.0 * static_cast<double>(count.violations) / static_cast<double>(count.states));
}

/// "unproved student" at the head of a column.
std::string capital(std::string text) {
  text.front() = static_cast<char>(std::toupper(text.front()));
  return text;
}

std::string rules_table(const Certificate& uncorrected, const Certificate& corrected,
                        ContextKind kind) {
  HtmlTable table{"Rules and their violations",
                  {"Rule", "Enforced by", "States", "Plain student: violations, %",
                   capital(own_student_name(corrected)) + ": violations"},
                  {}};
  const std::vector<DemandCount> after = demand_counts(corrected);
  const std::vector<DemandCount> before = demand_counts(uncorrected);
  for (std::size_t d = kPropertyCount; d < after.size(); ++d) {
    const bool is_bound = after[d].binds_student;
    table.rows.push_back({fmt::format("{} \u2013 {}", after[d].name, after[d].text),
                          held_by(corrected.rules.rules[d - kPropertyCount], kind),
                          is_bound ? grouped(after[d].states) : kNoValue,
                          d < before.size() ? percent_broken(before[d]) : kNoValue,
                          is_bound ? grouped(after[d].violations) : kNoValue});
  }
  return format_table(table);
}

}  // namespace

std::string whole_battery_html(const std::vector<NamedEvaluation>& evaluations) {
  if (evaluations.empty()) return {};
  HtmlTable table{
      "The configured battery of " + capacity_text(evaluations.front().any().capacity_mwh),
      {"Policy", "EUR of this battery per day, day-reset",
       "EUR of this battery per day, SoC carried over"},
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
      "the configured battery of {}: {} {} EUR per day, {} with the SoC carried over (only the "
      "ratio power_w / capacity_wh matters to the student; [battery] sets the size)\n",
      capacity_text(exported->any().capacity_mwh), exported->name, eur_per_day(exported->day_reset),
      eur_per_day(exported->carried_over));
}

std::string same_program_text(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* program = find_evaluation(evaluations, kOutlookProgramName);
  if (program == nullptr) program = find_evaluation(evaluations, kProgramName);
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
        "{} and {} make the same decision at every step: training showed no significant gain "
        "over the stochastic program on validation days, so the program is kept, which is normal",
        program->name, teacher->name);
  }
  return fmt::format(
      "{} and {} are the same program, fitted on the same days, with the same decision at every "
      "step",
      program->name, kProgramAsTeacher);
}

std::string grouped(std::int64_t count) {
  const std::string digits = fmt::format("{}", count);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string comparison_html(const std::vector<NamedEvaluation>& evaluations) {
  const auto reset = comparison_rows(evaluations, &NamedEvaluation::day_reset);
  const auto carried = comparison_rows(evaluations, &NamedEvaluation::carried_over);
  if (reset.empty() && carried.empty()) return {};
  return fmt::format(
      "{}{}<p class=\"note\">Profit, gain and their errors in EUR per day per MWh of capacity. "
      "Gain: mean day-by-day "
      "difference to {}; s.e.: standard error of the mean to its left; by month: {}. A gain within "
      "{} is not significant. Cycles: full cycles (throughput over twice the capacity); switches: "
      "changes of "
      "the order. At wear {:g}: {}.</p>\n",
      comparison_table("SoC carried over from day to day", carried),
      comparison_table("Day-reset: each day starts at the same SoC", reset),
      html_escaped(evaluations.front().name),
      html_escaped(by_month_meaning(evaluations.front().any().errors().months)), kIntervalMeaning,
      kReferenceWearEurPerMwh,
      html_escaped(reference_wear_meaning(evaluations.front().any().wear_eur_per_mwh)));
}

std::string proof_html(const Certificate& uncorrected, const Certificate& corrected) {
  HtmlTable table{
      "Violations before and after the correction",
      {"Student", "States checked", "Not charging at low price", "Not discharging at high price",
       "Pairs out of order"},
      {proof_cells(kPlainName, uncorrected), proof_cells(own_student_name(corrected), corrected)}};
  const PriceThresholds t = corrected.thresholds;
  return fmt::format(
      "{}<p class=\"note\">Checked over all lattice states of minute, quarter-hour, context class, "
      "SoC and price: charge at or below {} EUR/MWh{}, discharge at or above {}{}, and never more "
      "charging at a higher price or SoC.</p>\n",
      format_table(table), with_true_minus(fmt::format("{}", t.low_eur_per_mwh)),
      guard_alone_note(t.low_binds_student()), t.high_eur_per_mwh,
      guard_alone_note(t.high_binds_student()));
}

std::string rules_html(const Certificate& uncorrected, const Certificate& corrected,
                       ContextKind kind, const RulePrices* prices) {
  if (corrected.rules.empty()) return {};
  std::string text = rules_table(uncorrected, corrected, kind);
  std::string note = fmt::format("The plain student is checked on a sample, the {} in all states.",
                                 own_student_name(corrected));
  if (prices != nullptr) {
    text += format_table("Effect of the rules", rule_prices_table(*prices));
    note += fmt::format(
        " EUR/day/MWh: EUR per day per MWh of capacity, \u00b1 standard error, SoC carried over. "
        "The effect of a rule is measured on the plain student: each decision is moved to the "
        "nearest allowed "
        "one, and the days are run again, for each rule and all together. The difference to the {} "
        "is {}. Rules on the direction of time or context are part of the correction.",
        prices->student, prices->correction.meaning);
  }
  return text + fmt::format("<p class=\"note\">{}</p>\n", note);
}

std::string failure_html(const std::vector<BrokenDemand>& broken) {
  if (broken.empty()) return {};
  std::string text = "<dl class=\"facts\" id=\"broken\">\n";
  for (std::size_t i = 0; i < broken.size(); ++i) {
    const BrokenDemand& demand = broken[i];
    const std::string example =
        demand.example.empty() ? "" : fmt::format("; its action is {}", demand.example);
    text += fmt::format("<dt>{}</dt><dd>{}: <strong>{} violations</strong>{}. Remedy: {}.{}</dd>\n",
                        html_escaped(demand.count.label()),
                        html_escaped(with_true_minus(demand.count.text)),
                        grouped(demand.count.violations), html_escaped(with_true_minus(example)),
                        html_escaped(demand.advice),
                        demand.state ? fmt::format(" <button type=\"button\" data-broken=\"{}\">"
                                                   "Show this state on the map</button>",
                                                   i)
                                     : "");
  }
  return text +
         "</dl>\n<p class=\"note\">The unproved student is that of the last round and cannot be "
         "exported. The button above its map shows more violations.</p>\n";
}

std::string proof_sentence(const Certificate& c) {
  if (c.violations() != 0) {
    std::string which;
    for (const DemandCount& count : demand_counts(c)) {
      if (count.violations == 0) continue;
      which += fmt::format("{}{}: {}", which.empty() ? "" : ", ", count.label(),
                           grouped(count.violations));
    }
    return fmt::format("Not proved: {} violations ({}); it cannot be exported",
                       grouped(c.violations()), which);
  }
  const auto bound = std::ranges::count_if(c.rule_counts(), &RuleCount::binds_student);
  return fmt::format(
      "{}: no violation {}in {} states",
      c.covers_lattice_without_violation() ? "Proved" : "Partly checked",
      bound == 0 ? "" : fmt::format("of the properties and {} ", counted(bound, "rule")),
      grouped(c.states_checked));
}

std::string provenance_html(const Entries& facts, const std::string& lines) {
  std::string text = "<dl class=\"facts\">\n";
  for (const auto& [name, value] : facts) {
    text += fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_escaped(name), html_escaped(value));
  }
  text += "</dl>\n";
  if (!lines.empty()) text += fmt::format("<pre>{}</pre>\n", html_escaped(lines));
  return text;
}

}  // namespace bess
