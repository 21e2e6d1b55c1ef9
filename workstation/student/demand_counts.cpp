#include "workstation/student/demand_counts.h"

#include <fmt/core.h>

namespace bess {

std::string DemandCount::label() const { return is_rule ? fmt::format("rule \"{}\"", name) : name; }

std::vector<DemandCount> demand_counts(const Certificate& c) {
  const auto property = [&](int number, std::string text, bool binds, std::int64_t violations) {
    return DemandCount{fmt::format("property {}", number), std::move(text), false, binds,
                       binds ? c.states_checked : 0,       violations};
  };
  std::vector<DemandCount> counts{
      property(1, fmt::format("charge at or below {} EUR/MWh", c.thresholds.low_eur_per_mwh),
               c.thresholds.low_binds_student(), c.violations_property_1),
      property(2, fmt::format("discharge at or above {} EUR/MWh", c.thresholds.high_eur_per_mwh),
               c.thresholds.high_binds_student(), c.violations_property_2),
      property(3, "monotone in price and SoC", true, c.violations_property_3)};
  for (std::size_t r = 0; r < c.rules.rules.size(); ++r) {
    const Rule& rule = c.rules.rules[r];
    const RuleCount found = r < c.rule_counts.size() ? c.rule_counts[r] : RuleCount{};
    counts.push_back(
        {rule.name, rule.text(), true, found.binds_student, found.states, found.violations});
  }
  return counts;
}

std::string broken_text(const std::vector<DemandCount>& counts) {
  std::string text;
  for (const DemandCount& count : counts) {
    if (count.violations == 0) continue;
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", count.label(), count.violations);
  }
  return text;
}

}  // namespace bess
