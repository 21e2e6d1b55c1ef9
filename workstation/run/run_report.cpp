#include "workstation/run/run_report.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/env/charge_left.h"
#include "workstation/report/comparison_notes.h"
#include "workstation/report/headline.h"
#include "workstation/report/judged_days.h"
#include "workstation/report/report_tables.h"
#include "workstation/report/rule_prices.h"
#include "workstation/report/shown_policies.h"
#include "workstation/rules/ruled_policy.h"
#include "workstation/run/run_facts.h"
#include "workstation/student/demand_counts.h"
#include "workstation/student/exported_policy.h"
#include "workstation/student/student_policy.h"

namespace bess {
namespace {

NamedEvaluation evaluate_both(const std::string& name, Policy& policy, const RunResults& run) {
  EvaluationOptions options{run.config.battery, run.config.initial_soc_frac, false};
  const std::vector<MarketDay> days = run.market.days_of(Split::kTest);
  NamedEvaluation named;
  named.name = name;
  named.day_reset = evaluate(run.market, days, policy, options);
  options.carry_soc = true;
  named.carried_over = evaluate(run.market, days, policy, options);
  value_charge_left(named.carried_over, run.config.battery,
                    mean_settled_eur_per_mwh(run.market, days));
  return named;
}

/// Before and after the correction: the properties in one line each, and a line a rule.
std::string violations_text(const Certificate& plain, const Certificate& corrected) {
  const auto properties = [](const Certificate& c) {
    return fmt::format("{} / {} / {} in {} states", c.violations_of(1), c.violations_of(2),
                       c.violations_of(3), c.states_checked);
  };
  const std::string before_head = fmt::format("before correction ({})", kPlainName);
  const std::string after_head = fmt::format("after correction ({})", own_student_name(corrected));
  const auto lines = [&](const std::string& of_plain, const std::string& of_corrected) {
    return fmt::format("  {:<36} {}\n  {:<36} {}\n", before_head, of_plain, after_head,
                       of_corrected);
  };
  std::string text =
      "\nviolations of properties 1 / 2 / 3\n" + lines(properties(plain), properties(corrected));
  const std::vector<DemandCount> before = demand_counts(plain);
  const std::vector<DemandCount> after = demand_counts(corrected);
  for (std::size_t d = kPropertyCount; d < after.size(); ++d) {
    text += fmt::format("violations of rule \"{}\" ({})\n", after[d].name, after[d].text);
    if (!after[d].binds_student) {
      text += "  the guard's alone: no student is held to it\n";
      continue;
    }
    const auto counted = [](const DemandCount& count) {
      return fmt::format("{} in {} states", count.violations, count.states);
    };
    text += lines(counted(before[d]), counted(after[d]));
  }
  return text;
}

/// The plain student, also as each rule would hold it.
void evaluate_plain(const RunResults& run, std::vector<NamedEvaluation>& all) {
  const auto plain = std::make_shared<StudentPolicy>(run.plain->net, run.plain->outlook);
  all.push_back(evaluate_both(kPlainName, *plain, run));
  const auto under = [&](const std::string& name, const RuleSet& rules) {
    RuledPolicy ruled(plain, rules, run.plain->net.context);
    all.push_back(evaluate_both(name, ruled, run));
  };
  const RuleSet projected = projected_rules(run.corrected.certificate.rules);
  for (const Rule& rule : projected.rules) under(under_rule_name(rule.name), {{rule}});
  if (!projected.empty()) under(kUnderAllRules, projected);
}

/// So often that a warranty may not allow it, and what to set then.
std::string cycles_text(const StudentFile& student) {
  if (!student.cycles_per_day) return {};
  return fmt::format(
      "expect about {:.1f} full cycles a day of it (validation days); limit them by [battery] "
      "wear_eur_per_mwh or cycles_per_day_max\n",
      *student.cycles_per_day);
}

}  // namespace

void require_test_days(const MarketSteps& market, const std::string& prices) {
  if (!market.days_of(Split::kTest).empty()) return;
  fail("{}: no test days (local days 26 to the end); add some", prices);
}

std::vector<NamedEvaluation> evaluate_run(const RunResults& run) {
  std::vector<NamedEvaluation> all;
  const auto baseline = [&](const std::string& name) {
    const auto policy = make_baseline(name, run.market, run.config.battery);
    all.push_back(evaluate_both(name, *policy, run));
  };
  for (const std::string& name : baseline_names(kInRuns)) {
    if (name != kForesightName) baseline(name);
  }
  if (run.teacher.outlook) {  // both accountings trade the same
    const std::vector<MarketDay> days = run.market.days_of(Split::kTest);
    run.teacher.outlook->prepare(run.market, days, run.config.train.threads);
    run.teacher.book->prepare(run.market, days, run.config.train.threads);
  }
  TeacherPolicy teacher(run.teacher);
  all.push_back(evaluate_both(teacher_name(run.teacher), teacher, run));
  if (run.plain) evaluate_plain(run, all);
  all.push_back(evaluate_both(own_student_name(run.corrected.certificate),
                              *exported_policy(run.corrected), run));
  baseline(kForesightName);
  return all;
}

std::vector<std::string> write_run_report(const RunResults& run,
                                          const std::vector<NamedEvaluation>& evaluations,
                                          const RunFolder& folder) {
  const ReportInputs inputs{
      .market = run.market,
      .battery = run.config.battery,
      .initial_soc_frac = run.config.initial_soc_frac,
      .evaluations = evaluations,
      .training_curve = run.training_curve,
      .distil_curve = run.distil_curve,
      .checkpoints = run.checkpoints,
      .teacher = &run.teacher,
      .uncorrected = &*run.plain,
      .corrected = &run.corrected,
      .broken = broken_demands(run.corrected, run.config.distil.method),
      .walk_forward = run.walk_forward,
      .provenance = run.corrected.provenance,
      .facts = run_facts(run.config, run.market, folder),
  };
  std::vector<std::string> names = write_report(inputs, folder.path);
  const Certificate& certificate = run.corrected.certificate;
  const std::string alike = same_program_text(evaluations);
  std::string summary = certificate.violations() == 0 ? "" : proof_sentence(certificate) + "\n\n";
  if (const auto headline = headline_of(evaluations)) {
    summary += headline_text(*headline) + judged_days_text(judged_days(run.market, Split::kTest)) +
               "\n" + walk_forward_text(run.walk_forward) + "\n\n";
  }
  summary += format_comparison_table(evaluations) + (alike.empty() ? "" : alike + "\n") +
             whole_battery_text(evaluations) + cycles_text(run.corrected) +
             violations_text(run.plain->certificate, certificate);
  if (const auto prices = rule_prices_of(evaluations)) {
    summary += '\n';
    summary += rule_prices_text(*prices);
  }
  write_file(folder.file(run_file::kSummary), summary);
  names.emplace_back(run_file::kSummary);
  return names;
}

}  // namespace bess
