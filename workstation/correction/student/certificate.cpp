#include "workstation/correction/student/certificate.h"

#include <fmt/core.h>

#include <algorithm>

namespace bess {

std::string DemandCount::label() const { return is_rule ? fmt::format("rule \"{}\"", name) : name; }

std::vector<DemandCount> demand_counts(const Certificate& c) {
  std::vector<DemandCount> counts;
  const RuleSet demands = c.demands();
  for (std::size_t d = 0; d < demands.rules.size(); ++d) {
    const Rule& rule = demands.rules[d];
    const RuleCount found = d < c.counts.size() ? c.counts[d] : RuleCount{};
    if (rule.property == 0) {
      counts.push_back({rule.name,
                        rule.text(),
                        true,
                        found.binds_student,
                        found.states,
                        found.violations,
                        {rule}});
    } else if (static_cast<std::size_t>(rule.property) == counts.size()) {  // its second direction
      counts.back().violations += found.violations;
      counts.back().rules.push_back(rule);
    } else {
      const bool binds = overlaps_lattice(rule.box);
      counts.push_back({fmt::format("property {}", rule.property),
                        property_text(rule.property, c.thresholds),
                        false,
                        binds,
                        binds ? c.states_checked : 0,
                        found.violations,
                        {rule}});
    }
  }
  return counts;
}

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
    violations = 0;  // the first entry counts for all
  }
}

bool Certificate::covers_lattice_without_violation() const {
  return states_checked == kLatticeStateCount && rule_counts().size() == rules.rules.size() &&
         violations() == 0;
}

}  // namespace bess
