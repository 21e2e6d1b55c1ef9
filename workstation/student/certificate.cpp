#include "workstation/student/certificate.h"

#include <algorithm>

namespace bess {

std::int64_t Certificate::violations() const {
  std::int64_t sum = 0;
  for (const RuleCount& count : counts) sum += count.violations;
  return sum;
}

std::int64_t Certificate::violations_of(int property) const {
  const RuleSet built_in = built_in_rules(thresholds);
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < std::min(counts.size(), kBuiltInRuleCount); ++i) {
    if (built_in.rules[i].property == property) sum += counts[i].violations;
  }
  return sum;
}

void Certificate::set_violations_of(int property, std::int64_t violations) {
  if (counts.size() < kBuiltInRuleCount) counts.resize(kBuiltInRuleCount);
  const RuleSet built_in = built_in_rules(thresholds);
  for (std::size_t i = 0; i < kBuiltInRuleCount; ++i) {
    if (built_in.rules[i].property != property) continue;
    counts[i].violations = violations;
    violations = 0;  // the first tells for all
  }
}

bool Certificate::covers_lattice_without_violation() const {
  return states_checked == kLatticeStateCount && rule_counts().size() == rules.rules.size() &&
         violations() == 0;
}

}  // namespace bess
