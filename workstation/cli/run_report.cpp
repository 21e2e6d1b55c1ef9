#include "workstation/cli/run_report.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/policy_factory.h"
#include "workstation/cli/run_facts.h"
#include "workstation/env/evaluate.h"
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
  return named;
}

}  // namespace

void require_test_days(const MarketSteps& market) {
  if (!market.days_of(Split::kTest).empty()) return;
  fail("no test days (local days 26 to the end) in these prices; add some");
}

std::vector<NamedEvaluation> evaluate_run(const RunResults& run) {
  std::vector<NamedEvaluation> all;
  const auto baseline = [&](const char* name) {
    const auto policy = make_policy(name, run.market, run.config.battery);
    all.push_back(evaluate_both(name, *policy, run));
  };
  for (const char* name : {"rbc", "rbc-quartile", "rbc-tuned", "tabular", "mpc", "sdp"})
    baseline(name);
  TeacherPolicy teacher(run.teacher);
  all.push_back(
      evaluate_both(fmt::format("{} teacher", method_name(run.teacher.method)), teacher, run));
  StudentPolicy plain(run.plain.net);
  all.push_back(evaluate_both("plain student", plain, run));
  StudentPolicy corrected(run.corrected.net);
  all.push_back(evaluate_both("corrected student", corrected, run));
  baseline("foresight");
  return all;
}

std::string write_run_report(const RunResults& run, const std::vector<NamedEvaluation>& evaluations,
                             const RunFolder& folder) {
  const ReportInputs inputs{
      .market = run.market,
      .battery = run.config.battery,
      .initial_soc_frac = run.config.initial_soc_frac,
      .evaluations = evaluations,
      .training_curve = run.training_curve,
      .distil_curve = run.distil_curve,
      .teacher = &run.teacher,
      .uncorrected = &run.plain,
      .corrected = &run.corrected,
      .provenance = run.corrected.provenance,
      .facts = run_facts(run.config, run.market, folder),
  };
  write_report(inputs, folder.path);
  const auto violations = [](const Certificate& c) {
    return fmt::format("{} / {} / {} in {} states", c.violations_property_1,
                       c.violations_property_2, c.violations_property_3, c.states_checked);
  };
  std::string summary =
      format_comparison_table(evaluations) + fmt::format(
                                                 "\nviolations of properties 1 / 2 / 3\n"
                                                 "  before correction (plain student)    {}\n"
                                                 "  after correction (corrected student) {}\n",
                                                 violations(run.plain.certificate),
                                                 violations(run.corrected.certificate));
  write_file(folder.file(run_file::kSummary), summary);
  return summary;
}

}  // namespace bess
