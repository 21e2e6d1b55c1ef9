#include "workstation/correction/rules/rule.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "shared/host/user_error.h"

namespace bess {

namespace {

constexpr double kPercentPerSocIndex = 100.0 / (kSocCount - 1);

std::string range_text(const std::string& what, double low, double high, bool has_low,
                       bool has_high, const std::string& unit) {
  if (has_low && has_high) return fmt::format("{} {:g} to {:g}{}", what, low, high, unit);
  return has_low ? fmt::format("{} at least {:g}{}", what, low, unit)
                 : fmt::format("{} at most {:g}{}", what, high, unit);
}

std::string box_text(const RuleBox& box) {
  const RuleBox all;
  std::vector<std::string> parts;
  if (box.quarter_hour_count != all.quarter_hour_count) {
    parts.push_back(
        hour_text(box.quarter_hour_first) + "-" +
        hour_text((box.quarter_hour_first + box.quarter_hour_count) % kQuarterHourCount));
  }
  if (box.months != all.months) parts.push_back("months " + members_text(box.months));
  if (box.context_classes != all.context_classes) {
    parts.push_back("classes " + members_text(box.context_classes));
  }
  const bool soc_low = box.soc_index_min != all.soc_index_min;
  const bool soc_high = box.soc_index_max != all.soc_index_max;
  if (soc_low || soc_high) {
    parts.push_back(range_text("SoC", box.soc_index_min * kPercentPerSocIndex,
                               box.soc_index_max * kPercentPerSocIndex, soc_low, soc_high, " %"));
  }
  const bool price_low = box.price_min_eur_per_mwh != all.price_min_eur_per_mwh;
  const bool price_high = box.price_max_eur_per_mwh != all.price_max_eur_per_mwh;
  if (price_low || price_high) {
    parts.push_back(range_text("price", box.price_min_eur_per_mwh, box.price_max_eur_per_mwh,
                               price_low, price_high, " EUR/MWh"));
  }
  return parts.empty() ? "always" : fmt::format("{}", fmt::join(parts, ", "));
}

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

std::string hour_text(int quarter_hour) {
  return fmt::format("{:02}:{:02}", quarter_hour / 4, quarter_hour % 4 * kMinutesPerQuarterHour);
}

std::string members_text(std::int32_t bits) {
  std::vector<int> members;
  for (int k = 0; k < 12; ++k) {
    if ((bits >> k & 1) != 0) members.push_back(k + 1);
  }
  return fmt::format("{}", fmt::join(members, ", "));
}

std::string Rule::text() const { return demand->text(box_text(box)); }

PriceThresholds RuleSet::thresholds(PriceThresholds otherwise) const {
  for (const Rule& rule : rules) {
    if (!rule.is_threshold) continue;
    if (rule.lowest() == Action::kCharge) {
      otherwise.low_eur_per_mwh = rule.box.price_max_eur_per_mwh;
    } else {
      otherwise.high_eur_per_mwh = rule.box.price_min_eur_per_mwh;
    }
  }
  return otherwise;
}

std::vector<Direction> RuleSet::directions() const {
  std::vector<Direction> all{{RuleInput::kSoc, -1}, {RuleInput::kPrice, -1}};
  for (const Rule& rule : rules) {
    const Direction direction = rule.demand->direction();
    if (direction.sign == 0 || std::ranges::find(all, direction) != all.end()) continue;
    all.push_back(direction);
  }
  return all;
}

std::vector<GuardRule> RuleSet::guard_rules() const {
  std::vector<GuardRule> enforced;
  for (const Rule& rule : rules) {
    if (!rule.enforce) continue;
    enforced.push_back({rule.box, {rule.actions(), rule.demand->power_permille_max()}});
  }
  return enforced;
}

bool binds_student(const Rule& rule, ContextKind kind) {
  if (!rule.demand->binds_student() || !overlaps_lattice(rule.box)) return false;
  return kind == ContextKind::kMonth || rule.box.months == kAllTwelve;
}

std::string held_by(const Rule& rule, ContextKind kind) {
  if (!binds_student(rule, kind)) return rule.enforce ? "guard" : "guard's own thresholds";
  return rule.enforce ? "student and guard" : "student";
}

bool overlaps_lattice(const RuleBox& box) {
  return box.price_min_eur_per_mwh <= kLatticePriceMaxEurPerMwh &&
         box.price_max_eur_per_mwh >= kLatticePriceMinEurPerMwh;
}

LatticeBox lattice_box_of(const RuleBox& box, ContextKind kind) {
  const auto price_index = [](std::int32_t price) {
    return std::clamp(price, kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh) -
           kLatticePriceMinEurPerMwh;
  };
  return {.price_first = price_index(box.price_min_eur_per_mwh),
          .price_last = price_index(box.price_max_eur_per_mwh),
          .soc_first = box.soc_index_min,
          .soc_last = box.soc_index_max,
          .classes = kind == ContextKind::kMonth ? box.months : box.context_classes};
}

bool holds_in_context(const RuleBox& box, ContextKind kind, int quarter_hour, int context_class) {
  const std::int32_t classes = kind == ContextKind::kMonth ? box.months : box.context_classes;
  return box.holds_at_hour(quarter_hour) && (classes >> (context_class - 1) & 1) != 0;
}

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
