#include "workstation/correction/rules/rule_conflicts.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "shared/host/user_error.h"

namespace bess {
namespace {

/// Range over which a demand applies along an input; "at least" extends towards larger actions.
void reach(int sign, bool at_least, int& first, int& last, int lowest, int highest) {
  if ((sign < 0) == at_least) {
    first = lowest;
  } else {
    last = highest;
  }
}

std::string state_text(int quarter_hour, int context_class, int soc_index, int price,
                       ContextKind kind) {
  return fmt::format("{} {}, {}, SoC {:g} %, {} EUR/MWh",
                     kind == ContextKind::kMonth ? "month" : "context class", context_class,
                     hour_text(quarter_hour), soc_index * 100.0 / (kSocCount - 1), price);
}

/// Adds the thresholds of properties 1 and 2 as rules, unless the set has its own.
RuleSet with_thresholds(const RuleSet& rules, const PriceThresholds& thresholds) {
  RuleSet all = rules;
  for (Rule rule : built_in_rules(thresholds).rules) {
    if (!rule.restricts_actions()) continue;
    const bool has_own = std::ranges::any_of(rules.rules, [&](const Rule& own) {
      return own.is_threshold && own.lowest() == rule.lowest();
    });
    if (has_own) continue;
    rule.name = rule.property == 1 ? "[correction] low_price_eur_per_mwh"
                                   : "[correction] high_price_eur_per_mwh";
    rule.place = "the configuration";
    rule.is_threshold = true;
    all.rules.push_back(std::move(rule));
  }
  return all;
}

[[noreturn]] void clash(const Rule& a, const Rule& b, const std::string& state) {
  fail("{}: \"{}\" contradicts \"{}\" ({}) at {}: narrow or remove one", a.place, a.name, b.name,
       b.place, state);
}

using QuarterHours = std::bitset<kQuarterHourCount>;

QuarterHours quarter_hours_of(const RuleBox& box) {
  QuarterHours held;
  for (int q = 0; q < kQuarterHourCount; ++q) {
    held[static_cast<std::size_t>(q)] = box.holds_at_hour(q);
  }
  return held;
}

/// Not for an empty set.
int first_of(const QuarterHours& held) {
  std::size_t q = 0;
  while (!held[q]) ++q;
  return static_cast<int>(q);
}

/// Contradictions between rules that the guard enforces at the same time.
void check_boxes(const Rule& a, const Rule& b, ContextKind kind) {
  if ((a.actions() & b.actions()) != 0) return;
  const int price = std::max(a.box.price_min_eur_per_mwh, b.box.price_min_eur_per_mwh);
  const int soc = std::max(a.box.soc_index_min, b.box.soc_index_min);
  const std::int32_t months = a.box.months & b.box.months;
  const std::int32_t classes = a.box.context_classes & b.box.context_classes;
  const QuarterHours held = quarter_hours_of(a.box) & quarter_hours_of(b.box);
  if (price > std::min(a.box.price_max_eur_per_mwh, b.box.price_max_eur_per_mwh) ||
      soc > std::min(a.box.soc_index_max, b.box.soc_index_max) || months == 0 || classes == 0 ||
      held.none()) {
    return;
  }
  const std::int32_t seen = kind == ContextKind::kMonth ? months : classes;
  clash(a, b,
        state_text(first_of(held), std::countr_zero(static_cast<unsigned>(seen)) + 1, soc, price,
                   kind));
}

void check_directions(const RuleSet& rules) {
  for (const Rule& a : rules.rules) {
    for (const Rule& b : rules.rules) {
      const Direction up = a.demand->direction();
      const Direction down = b.demand->direction();
      if (up.input == down.input && up.sign > 0 && down.sign < 0) {
        clash(a, b, "every state: only an action that is constant in that input satisfies both");
      }
    }
  }
}

void check_each(const RuleSet& rules, ContextKind kind) {
  for (const Rule& rule : rules.rules) {
    if (kind == ContextKind::kMonth && rule.box.context_classes != kAllTwelve) {
      fail(
          "{}: \"{}\" has context_classes, but the context is the month: use months, or [train] "
          "context = \"level\"",
          rule.place, rule.name);
    }
    const bool is_bound = binds_student(rule, kind) || rule.enforce || rule.is_threshold;
    if (is_bound) continue;
    fail("{}: \"{}\" has no effect: {}; add enforce = true for the guard", rule.place, rule.name,
         rule.box.months != kAllTwelve ? "the student's context is not the month"
                                       : "none of its prices is on the lattice");
  }
}

}  // namespace

void ImpliedRanges::add_bound(const Rule& rule, std::size_t index, BoundSide side, Action action,
                              const std::vector<Direction>& directions, ContextKind kind) {
  ImpliedBound bound{
      side, action, 0, index, lattice_box_of(rule.box, kind), quarter_hours_of(rule.box)};
  for (int a = 0; a < kActionCount; ++a) {
    const auto other = static_cast<Action>(a);
    const bool is_allowed = side == BoundSide::kAtLeast  ? other >= action
                            : side == BoundSide::kAtMost ? other <= action
                                                         : other != action;
    if (is_allowed) bound.allowed = static_cast<ActionSet>(bound.allowed | action_bit(other));
  }
  for (const Direction& direction : directions) {
    if (side == BoundSide::kNotIdle) break;  // implies nothing for other states
    const bool at_least = side == BoundSide::kAtLeast;
    LatticeBox& box = bound.box;
    if (direction.input == RuleInput::kPrice) {
      reach(direction.sign, at_least, box.price_first, box.price_last, 0, kPriceCount - 1);
    } else if (direction.input == RuleInput::kSoc) {
      reach(direction.sign, at_least, box.soc_first, box.soc_last, 0, kSocCount - 1);
    } else if (direction.input == RuleInput::kContextClass) {
      int first = std::countr_zero(static_cast<unsigned>(box.classes));
      int last = static_cast<int>(std::bit_width(static_cast<unsigned>(box.classes))) - 1;
      reach(direction.sign, at_least, first, last, 0, kContextClassCount - 1);
      for (int c = first; c <= last; ++c) box.classes |= 1 << c;
    } else if (direction.input == RuleInput::kQuarterHour) {
      QuarterHours& held = bound.quarter_hours;
      int first = first_of(held);
      int last = kQuarterHourCount - 1;
      while (!held[static_cast<std::size_t>(last)]) --last;
      reach(direction.sign, at_least, first, last, 0, kQuarterHourCount - 1);
      for (int q = first; q <= last; ++q) held.set(static_cast<std::size_t>(q));
    }
  }
  bounds_.push_back(std::move(bound));
}

ImpliedRanges::ImpliedRanges(const RuleSet& rules, ContextKind kind) {
  const std::vector<Direction> directions = rules.directions();
  for (std::size_t i = 0; i < rules.rules.size(); ++i) {
    const Rule& rule = rules.rules[i];
    if (!binds_student(rule, kind)) continue;
    if (rule.has_gap()) add_bound(rule, i, BoundSide::kNotIdle, Action::kIdle, directions, kind);
    if (rule.lowest() > Action::kDischarge) {
      add_bound(rule, i, BoundSide::kAtLeast, rule.lowest(), directions, kind);
    }
    if (rule.highest() < Action::kCharge) {
      add_bound(rule, i, BoundSide::kAtMost, rule.highest(), directions, kind);
    }
  }
}

ActionSet ImpliedRanges::at(int quarter_hour, int context_class, int soc_index,
                            int price_eur_per_mwh) const {
  const int price = price_eur_per_mwh - kLatticePriceMinEurPerMwh;
  ActionSet actions = kAllActions;
  for (const ImpliedBound& bound : bounds_) {
    const LatticeBox& box = bound.box;
    if (box.contains(soc_index, price) && (box.classes >> (context_class - 1) & 1) != 0 &&
        bound.quarter_hours[static_cast<std::size_t>(quarter_hour)]) {
      actions = static_cast<ActionSet>(actions & bound.allowed);
    }
  }
  return actions;
}

void require_consistent(const RuleSet& rules, const PriceThresholds& thresholds, ContextKind kind) {
  check_each(rules, kind);
  check_directions(rules);
  const PriceThresholds tightened = rules.thresholds(thresholds);
  if (!tightened.are_ordered()) {
    fail(
        "the thresholds of the rules and of [correction] cross: charge at or below {} and "
        "discharge at or above {} EUR/MWh; change one of them",
        tightened.low_eur_per_mwh, tightened.high_eur_per_mwh);
  }
  for (const Rule& a : rules.rules) {
    for (const Rule& b : rules.rules) {
      if (&a < &b && a.enforce && b.enforce) check_boxes(a, b, kind);
    }
  }
  const RuleSet all = with_thresholds(rules, thresholds);
  const ImpliedRanges implied(all, kind);
  // Corner of the common states of the bounds; each such set is a box, or hours and classes of
  // boxes.
  const auto meet = [kind](std::initializer_list<const ImpliedBound*> bounds, std::string& state) {
    LatticeBox common{0, kPriceCount - 1, 0, kSocCount - 1, kAllTwelve};
    QuarterHours held = QuarterHours().set();
    for (const ImpliedBound* bound : bounds) {
      common.price_first = std::max(common.price_first, bound->box.price_first);
      common.price_last = std::min(common.price_last, bound->box.price_last);
      common.soc_first = std::max(common.soc_first, bound->box.soc_first);
      common.soc_last = std::min(common.soc_last, bound->box.soc_last);
      common.classes &= bound->box.classes;
      held &= bound->quarter_hours;
    }
    if (common.price_first > common.price_last || common.soc_first > common.soc_last ||
        common.classes == 0 || held.none()) {
      return false;
    }
    state = state_text(first_of(held), std::countr_zero(static_cast<unsigned>(common.classes)) + 1,
                       common.soc_first, kLatticePriceMinEurPerMwh + common.price_first, kind);
    return true;
  };
  std::string state;
  for (const ImpliedBound& least : implied.bounds()) {
    if (least.side != BoundSide::kAtLeast) continue;
    for (const ImpliedBound& most : implied.bounds()) {
      if (most.side != BoundSide::kAtMost) continue;
      const Rule& a = all.rules[least.rule];
      const Rule& b = all.rules[most.rule];
      if (least.action > most.action && meet({&least, &most}, state)) clash(a, b, state);
      if (least.action != Action::kIdle || most.action != Action::kIdle) continue;
      for (const ImpliedBound& gap : implied.bounds()) {
        if (gap.side != BoundSide::kNotIdle || !meet({&least, &most, &gap}, state)) continue;
        clash(all.rules[gap.rule], least.rule == most.rule ? a : b, state);
      }
    }
  }
}

std::optional<Opposite> nearest_opposite(const RuleSet& rules, const PriceThresholds& thresholds,
                                         ContextKind kind, const Rule& rule) {
  const RuleSet all = with_thresholds(rules, thresholds);
  const ImpliedRanges implied(all, kind);
  const auto is_asked = [&](const ImpliedBound& bound) {
    const Rule& other = all.rules[bound.rule];
    return other.box == rule.box && other.actions() == rule.actions();
  };
  const auto meet_in_time = [](const ImpliedBound& a, const ImpliedBound& b) {
    return (a.box.classes & b.box.classes) != 0 && (a.quarter_hours & b.quarter_hours).any();
  };
  std::optional<Opposite> nearest;
  for (const ImpliedBound& least : implied.bounds()) {
    for (const ImpliedBound& most : implied.bounds()) {
      if (least.side != BoundSide::kAtLeast || most.side != BoundSide::kAtMost ||
          least.action <= most.action || is_asked(least) == is_asked(most) ||
          !meet_in_time(least, most)) {
        continue;
      }
      const Rule& other = all.rules[is_asked(least) ? most.rule : least.rule];
      const Opposite found{other.name, std::max(0, most.box.price_first - least.box.price_last),
                           std::max(0, most.box.soc_first - least.box.soc_last)};
      const auto distance = [](const Opposite& o) { return o.price_gap_eur_per_mwh + o.soc_gap; };
      if (!nearest || distance(found) < distance(*nearest)) nearest = found;
    }
  }
  return nearest;
}

}  // namespace bess
