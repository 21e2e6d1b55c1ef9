// Student as the edge runs it: with the rules of its guard, and nothing more.
#include "workstation/correction/student/student_policy.h"

#include <gtest/gtest.h>

#include "tests/support/rule_sets.h"
#include "tests/support/student_nets.h"

namespace bess {
namespace {

constexpr int kEvening = 76;  ///< 19:00

MarketStep step_at(int quarter_hour, double price) {
  MarketStep step{};
  step.quarter_hour = static_cast<std::int8_t>(quarter_hour);
  step.month = 1;
  step.observed_eur_per_mwh = price;
  return step;
}

TEST(ExportedPolicy, IsTheStudentBehindItsGuard) {
  StudentFile student{.net = LinearNet{}.net(), .certificate = {}, .provenance = ""};
  student.certificate.rules = one_rule("hours = \"18:00-21:00\"\npower_max = 0.5\nenforce = true");
  RuleSet& rules = student.certificate.rules;
  rules.rules.push_back(
      one_rule("hours = \"18:00-21:00\"\nat_least = \"idle\"\nenforce = true", "keep").rules[0]);
  rules.rules.push_back(one_rule("at_most = \"idle\"", "not enforced").rules[0]);
  const std::unique_ptr<Policy> policy = exported_policy(student);
  EXPECT_EQ(policy->decide(step_at(0, 1400), 0, 0.5), Action::kDischarge) << "as the student";
  EXPECT_EQ(policy->decide(step_at(kEvening, 1400), 0, 0.5), Action::kIdle) << "the guard's";
  EXPECT_EQ(policy->decide(step_at(kEvening, -400), 0, 0.5), Action::kCharge)
      << "a rule without enforce only affects the proof";
  EXPECT_EQ(policy->power_share_max(step_at(0, 0), 0.5), 1);
  EXPECT_EQ(policy->power_share_max(step_at(kEvening, 0), 0.5), 0.5);
}

}  // namespace
}  // namespace bess
