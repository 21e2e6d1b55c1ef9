#include "workstation/correction/student/student_policy.h"

#include "workstation/correction/rules/ruled_policy.h"

namespace bess {

std::unique_ptr<Policy> exported_policy(const StudentFile& student) {
  auto policy = std::make_unique<StudentPolicy>(student.net, student.outlook);
  const RuleSet& rules = student.certificate.rules;
  if (rules.guard_rules().empty()) return policy;
  return std::make_unique<GuardedPolicy>(std::move(policy), rules, student.net.context);
}

}  // namespace bess
