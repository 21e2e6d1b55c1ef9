#include "workstation/correction/rule_lessons.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace bess {
namespace {

int lattice_value(float input, int scale) {
  return static_cast<int>(std::lround(double{input} * kInputOne / scale));
}

/// The k-th member of a set of classes.
int class_at(std::int32_t classes, std::size_t k) {
  int context_class = 0;
  while (true) {
    if ((classes >> context_class++ & 1) != 0 && k-- == 0) return context_class;
  }
}

}  // namespace

RuleLessons::RuleLessons(const RuleSet& rules, ContextKind kind)
    : kind_(kind), implied_(rules, kind) {
  for (std::size_t r = 0; r < rules.rules.size(); ++r) {
    const Rule& rule = rules.rules[r];
    if (!binds_student(rule, kind) || !rule.restricts_actions()) continue;
    asked_.push_back({r, rule, lattice_box_of(rule.box, kind), !rule.has_gap()});
  }
}

bool RuleLessons::holds(const Asked& asked, const LatticeState& context) const {
  return holds_in_context(asked.rule.box, kind_, context.quarter_hour, context.context_class);
}

/// "At least" is hardest at the highest price and SoC, "at most" at the lowest.
HardState RuleLessons::corner(const Asked& asked, LatticeState context, bool at_least) {
  const LatticeBox& box = asked.box;
  context.soc_index = static_cast<std::int16_t>(at_least ? box.soc_last : box.soc_first);
  context.price_eur_per_mwh = static_cast<std::int16_t>(
      kLatticePriceMinEurPerMwh + (at_least ? box.price_last : box.price_first));
  return {context, asked.rule.actions(), asked.index};
}

/// An operator's rule draws its hour before the minute, a built-in one behind it: so the students
/// were made that are in use, and a seed gives them again.
LatticeState RuleLessons::draw_context(const Asked& asked, Random& random) const {
  const RuleBox& box = asked.rule.box;
  const bool hour_first = asked.rule.property == 0;
  const auto draw_hour = [&] {
    return static_cast<int>(random.index(static_cast<std::size_t>(box.quarter_hour_count)));
  };
  int since = hour_first ? draw_hour() : 0;
  LatticeState context{};
  context.minute_of_quarter_hour =
      static_cast<std::int16_t>(random.index(kMinuteOfQuarterHourCount));
  if (!hour_first) since = draw_hour();
  context.quarter_hour =
      static_cast<std::int16_t>((box.quarter_hour_first + since) % kQuarterHourCount);
  const auto classes = std::popcount(static_cast<unsigned>(asked.box.classes));
  context.context_class = static_cast<std::int16_t>(
      class_at(asked.box.classes, random.index(static_cast<std::size_t>(classes))));
  return context;
}

HardState RuleLessons::draw(std::size_t index, const std::vector<LatticeState>& counterexamples,
                            Random& random) const {
  const Asked& asked = asked_[index];
  LatticeState context{};
  const bool wants_known = !counterexamples.empty() && random.uniform() < 0.5;
  if (wants_known) context = counterexamples[random.index(counterexamples.size())];
  if (!wants_known || !holds(asked, context)) context = draw_context(asked, random);
  if (!asked.has_corners) {
    const auto between = [&random](int first, int last) {
      return first + static_cast<int>(random.index(static_cast<std::size_t>(last - first) + 1));
    };
    context.soc_index = static_cast<std::int16_t>(between(asked.box.soc_first, asked.box.soc_last));
    context.price_eur_per_mwh = static_cast<std::int16_t>(
        kLatticePriceMinEurPerMwh + between(asked.box.price_first, asked.box.price_last));
    return {context, asked.rule.actions(), asked.index};
  }
  const bool has_lower = asked.rule.lowest() > Action::kDischarge;
  const bool has_upper = asked.rule.highest() < Action::kCharge;
  const bool at_least = has_lower && (!has_upper || random.uniform() < 0.5);
  return corner(asked, context, at_least);
}

void RuleLessons::corners(const LatticeState& context, std::vector<HardState>& states) const {
  states.clear();
  for (const Asked& asked : asked_) {
    if (!asked.has_corners || !holds(asked, context)) continue;
    if (asked.rule.lowest() > Action::kDischarge) states.push_back(corner(asked, context, true));
    if (asked.rule.highest() < Action::kCharge) states.push_back(corner(asked, context, false));
  }
}

ActionSet RuleLessons::actions_at(const float* x, const PriceMap& price_map) const {
  const int price = std::clamp(static_cast<int>(std::lround(price_map.price_of(x[4]))),
                               kLatticePriceMinEurPerMwh, kLatticePriceMaxEurPerMwh);
  return implied_
      .at(lattice_value(x[1], kQuarterHourScale), lattice_value(x[2], kContextClassScale) + 1,
          std::clamp(lattice_value(x[3], kSocScale), 0, kSocCount - 1), price)
      .set();
}

}  // namespace bess
