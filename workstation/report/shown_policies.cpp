#include "workstation/report/shown_policies.h"

#include <fmt/core.h>

#include "workstation/report/headline.h"
#include "workstation/student/exported_policy.h"
#include "workstation/student/student_policy.h"

namespace bess {

std::string teacher_name(const Teacher& teacher) {
  return fmt::format("{} teacher", method_name(teacher.method));
}

const char* own_student_name(const Certificate& certificate) {
  return certificate.violations() == 0 ? kCorrectedName : kUnprovedName;
}

std::vector<ShownPolicy> shown_policies(const ReportInputs& in) {
  std::vector<ShownPolicy> policies;
  if (in.corrected) {
    policies.push_back(
        {own_student_name(in.corrected->certificate), exported_policy(*in.corrected)});
  }
  if (in.uncorrected) {
    policies.push_back({kPlainName, std::make_unique<StudentPolicy>(in.uncorrected->net,
                                                                    in.uncorrected->outlook)});
  }
  if (in.teacher) policies.push_back({"teacher", std::make_unique<TeacherPolicy>(*in.teacher)});
  if (policies.empty()) {
    policies.push_back(
        {"rule-based controller",
         std::make_unique<RuleBasedPolicy>(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh)});
  }
  return policies;
}

double rule_validation_profit(const MarketSteps& market, const BatteryParameters& battery) {
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  EvaluationOptions options;
  options.battery = battery;
  options.carry_soc = true;
  return evaluate(market, market.days_of(Split::kValidation), rule, options)
      .profit_eur_per_day_per_mwh();
}

}  // namespace bess
