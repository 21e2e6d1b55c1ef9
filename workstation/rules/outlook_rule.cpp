#include "workstation/rules/outlook_rule.h"

#include <algorithm>

#include "shared/host/user_error.h"

namespace bess {

RuleSet with_outlook_rule(const RuleSet& rules) {
  constexpr std::string_view kName = "break-even price";
  const Direction direction{RuleInput::kContextClass, 1};
  RuleSet all = rules;
  for (const Rule& rule : rules.rules) {
    if (rule.demand->direction() == direction) return all;
    if (rule.name == kName) {
      fail("{}: the name \"{}\" is that of a rule of every student by outlook; give it another",
           rule.place, kName);
    }
    if (rule.box.context_classes != RuleBox{}.context_classes) {
      fail(
          "{}: rule \"{}\" names context classes: by outlook they are classes of the plan's "
          "break-even price, which the guard does not know; name prices or hours",
          rule.place, rule.name);
    }
  }
  Rule rule;
  rule.name = kName;
  rule.demand = direction_demand(direction);
  all.rules.push_back(rule);
  return all;
}

}  // namespace bess
