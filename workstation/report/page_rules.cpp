#include "workstation/report/page_rules.h"

#include <array>

namespace bess {
namespace {

constexpr std::array<const char*, kRuleInputCount> kInputNames{"minute", "quarterHour",
                                                               "contextClass", "soc", "price"};

Json pair(int first, int second) {
  Json list = Json::list();
  list.add(first);
  list.add(second);
  return list;
}

Json forbidden_actions(const Rule& rule) {
  Json list = Json::list();
  for (int a = 0; a < kActionCount; ++a) {
    if (!allows(rule.actions(), static_cast<Action>(a))) list.add(a);
  }
  return list;
}

Json rule_json(const Rule& rule, ContextKind kind) {
  Json json = Json::object({{"name", rule.name},
                            {"text", rule.text()},
                            {"held_by", held_by(rule, kind)},
                            {"binds_student", binds_student(rule, kind)}});
  if (const Direction direction = rule.demand->direction(); direction.sign != 0) {
    json.set("direction",
             Json::object({{"input", kInputNames[static_cast<std::size_t>(direction.input)]},
                           {"sign", direction.sign}}));
    return json;
  }
  const LatticeBox box = lattice_box_of(rule.box, kind);
  json.set("hours", pair(rule.box.quarter_hour_first, rule.box.quarter_hour_count));
  json.set("classes", box.classes);
  json.set("soc", pair(box.soc_first, box.soc_last));
  if (overlaps_lattice(rule.box)) {
    json.set("price", pair(kLatticePriceMinEurPerMwh + box.price_first,
                           kLatticePriceMinEurPerMwh + box.price_last));
  }
  if (rule.restricts_actions() && !rule.is_threshold) {
    json.set("forbidden", forbidden_actions(rule));
  }
  return json;
}

}  // namespace

Json rules_json(const RuleSet& rules, ContextKind kind) {
  Json list = Json::list();
  for (const Rule& rule : rules.rules) list.add(rule_json(rule, kind));
  return list;
}

}  // namespace bess
