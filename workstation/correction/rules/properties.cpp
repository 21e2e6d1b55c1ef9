#include "workstation/correction/rules/properties.h"

#include <fmt/core.h>

#include "shared/host/user_error.h"

namespace bess {

RuleSet with_outlook_rule(const RuleSet& rules) {
  constexpr std::string_view kName = "break-even price";
  const Direction direction{RuleInput::kContextClass, 1};
  RuleSet all = rules;
  bool has_direction = false;
  for (const Rule& rule : rules.rules) {
    if (rule.demand->direction() == direction) {
      has_direction = true;
      continue;
    }
    if (rule.name == kName) {
      fail("{}: the name \"{}\" is reserved with context = \"outlook\"; rename the rule",
           rule.place, kName);
    }
    if (rule.box.context_classes != RuleBox{}.context_classes) {
      fail(
          "{}: rule \"{}\" has context_classes: with context = \"outlook\" they are classes "
          "of the plan's break-even price, which the guard does not know; use prices or hours",
          rule.place, rule.name);
    }
  }
  if (!has_direction) {
    all.rules.push_back(
        {.name = std::string(kName), .box = {}, .demand = direction_demand(direction)});
  }
  return all;
}

namespace {

Rule threshold(int property, Action action) {
  return {.name = fmt::format("property {}", property),
          .box = {},
          .demand = action_demand(action_bit(action)),
          .property = property};
}

Rule never_rises_with(RuleInput input, const char* name) {
  return {.name = fmt::format("property 3, {}", name),
          .box = {},
          .demand = direction_demand({input, -1}),
          .property = 3};
}

}  // namespace

RuleSet built_in_rules(const PriceThresholds& thresholds) {
  Rule cheap = threshold(1, Action::kCharge);
  cheap.box.price_max_eur_per_mwh = thresholds.low_eur_per_mwh;
  Rule dear = threshold(2, Action::kDischarge);
  dear.box.price_min_eur_per_mwh = thresholds.high_eur_per_mwh;
  return {{cheap, dear, never_rises_with(RuleInput::kPrice, "price"),
           never_rises_with(RuleInput::kSoc, "SoC")}};
}

RuleSet with_built_in(const PriceThresholds& thresholds, const RuleSet& rules) {
  RuleSet all = built_in_rules(thresholds);
  all.rules.insert(all.rules.end(), rules.rules.begin(), rules.rules.end());
  return all;
}

RuleSet with_properties(const RuleSet& rules, const PriceThresholds& thresholds) {
  return with_built_in(rules.thresholds(thresholds), rules);
}

std::string property_text(int property, const PriceThresholds& thresholds) {
  if (property == 1)
    return fmt::format("charge at or below {} EUR/MWh", thresholds.low_eur_per_mwh);
  if (property == 2) {
    return fmt::format("discharge at or above {} EUR/MWh", thresholds.high_eur_per_mwh);
  }
  return "monotone in price and SoC";
}

}  // namespace bess
