#include "workstation/correction/student/student_policy.h"

#include "workstation/correction/rules/ruled_policy.h"

namespace bess {
namespace {

class GuardedStudent final : public Policy {
 public:
  explicit GuardedStudent(const StudentFile& student)
      : student_(student.net, student.outlook),
        classes_(student.net.context),
        guard_rules_(student.certificate.rules.guard_rules()) {}

  [[nodiscard]] Action decide(const MarketStep& step, std::size_t index,
                              double soc_frac) const override {
    return nearest_allowed(limits_at(step, soc_frac).actions,
                           student_.decide(step, index, soc_frac));
  }
  [[nodiscard]] double power_share_max(const MarketStep& step, double soc_frac) const override {
    return limits_at(step, soc_frac).power_permille_max / double{kFullPowerPermille};
  }

 private:
  [[nodiscard]] RuleLimits limits_at(const MarketStep& step, double soc_frac) const {
    return rule_limits_at(guard_rules_, rule_point_of(step, soc_frac, classes_));
  }

  StudentPolicy student_;
  ContextClasses classes_;
  std::vector<GuardRule> guard_rules_;
};

}  // namespace

std::unique_ptr<Policy> exported_policy(const StudentFile& student) {
  if (student.certificate.rules.guard_rules().empty()) {
    return std::make_unique<StudentPolicy>(student.net, student.outlook);
  }
  return std::make_unique<GuardedStudent>(student);
}

}  // namespace bess
