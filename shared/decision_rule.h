// Operator rule in integers: a box of states and the allowed decisions. Proof and guard use the
// same rounding, so that the guard never changes a decision for a rule that the student is proved
// for. Rules use whole EUR/MWh, not clamped to the lattice: outside it only the guard applies them.
#pragma once

#include <cstdint>
#include <type_traits>

#include "shared/action.h"
#include "shared/crc32.h"
#include "shared/features.h"
#include "shared/fixed_point.h"
#include "shared/price_thresholds.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Actions as bits 0..2: discharge, idle, charge.
using ActionSet = std::uint8_t;
inline constexpr ActionSet kAllActions = (1U << kActionCount) - 1;

constexpr ActionSet action_bit(Action action) {
  return static_cast<ActionSet>(1U << static_cast<int>(action));
}
constexpr bool allows(ActionSet set, Action action) { return (set & action_bit(action)) != 0; }

/// The action if allowed, else the nearest allowed one, the lower of two. Idle if none is allowed.
constexpr Action nearest_allowed(ActionSet set, Action action) {
  const int wanted = static_cast<int>(action);
  for (int distance = 0; distance < kActionCount; ++distance) {
    for (const int other : {wanted - distance, wanted + distance}) {
      if (other < 0 || other >= kActionCount) continue;
      if (allows(set, static_cast<Action>(other))) return static_cast<Action>(other);
    }
  }
  return Action::kIdle;
}

inline constexpr std::uint16_t kAllTwelve = (1U << 12) - 1;  ///< months or context classes

/// Point at which rules are evaluated.
struct RulePoint {
  std::int32_t price_eur_per_mwh;  ///< nearest whole price, from whole_price_of()
  std::int16_t soc_index;          ///< in the lattice
  std::int16_t quarter_hour;       ///< local, 0..95
  std::int16_t month;              ///< local, 1..12
  std::int16_t context_class;      ///< 1..12
};

/// Nearest whole EUR/MWh, halves up, as lattice_price_of() without clamping to the lattice; clamped
/// to the largest bounds of a rule, so that unbounded rules include all prices.
constexpr std::int32_t whole_price_of(std::int32_t price_centi_eur_per_mwh) {
  return clamp_to(rounding_divide(price_centi_eur_per_mwh, kCentiPerEur), -kThresholdMaxEurPerMwh,
                  kThresholdMaxEurPerMwh);
}

/// Point of a decision; `state` has a clamped price.
constexpr RulePoint rule_point(const LocalMinute& now, const LatticeState& state,
                               std::int32_t price_centi_eur_per_mwh) {
  return {.price_eur_per_mwh = whole_price_of(price_centi_eur_per_mwh),
          .soc_index = state.soc_index,
          .quarter_hour = state.quarter_hour,
          .month = static_cast<std::int16_t>(now.month),
          .context_class = state.context_class};
}

/// Box with inclusive bounds.
struct RuleBox {
  std::int32_t price_min_eur_per_mwh = -kThresholdMaxEurPerMwh;  ///< includes lower prices
  std::int32_t price_max_eur_per_mwh = kThresholdMaxEurPerMwh;
  std::int32_t soc_index_min = 0;
  std::int32_t soc_index_max = kSocCount - 1;
  std::int32_t quarter_hour_first = 0;
  std::int32_t quarter_hour_count = kQuarterHourCount;  ///< from the first, also past midnight
  std::int32_t months = kAllTwelve;                     ///< bit m - 1
  std::int32_t context_classes = kAllTwelve;            ///< bit c - 1

  [[nodiscard]] constexpr bool holds_at_hour(int quarter_hour) const {
    const int since = quarter_hour - quarter_hour_first;
    return (since < 0 ? since + kQuarterHourCount : since) < quarter_hour_count;
  }
  [[nodiscard]] constexpr bool contains(const RulePoint& p) const {
    return p.price_eur_per_mwh >= price_min_eur_per_mwh &&
           p.price_eur_per_mwh <= price_max_eur_per_mwh && p.soc_index >= soc_index_min &&
           p.soc_index <= soc_index_max && holds_at_hour(p.quarter_hour) &&
           (months >> (p.month - 1) & 1) != 0 &&
           (context_classes >> (p.context_class - 1) & 1) != 0;
  }
  friend constexpr bool operator==(const RuleBox&, const RuleBox&) = default;
};

inline constexpr std::int32_t kFullPowerPermille = 1'000;

/// Allowed decisions at one point.
struct RuleLimits {
  ActionSet actions = kAllActions;
  std::int32_t power_permille_max = kFullPowerPermille;  ///< of the rated power, both directions
  friend constexpr bool operator==(const RuleLimits&, const RuleLimits&) = default;
};

/// Rule enforced by the guard.
struct GuardRule {
  RuleBox box;
  RuleLimits limits;
  friend constexpr bool operator==(const GuardRule&, const GuardRule&) = default;
};

/// Visits the fields in the order of a row of the exported header and of the hash.
template <typename Rule, typename Visit>
constexpr void for_each_field(Rule& rule, Visit visit) {
  visit(rule.box.price_min_eur_per_mwh);
  visit(rule.box.price_max_eur_per_mwh);
  visit(rule.box.soc_index_min);
  visit(rule.box.soc_index_max);
  visit(rule.box.quarter_hour_first);
  visit(rule.box.quarter_hour_count);
  visit(rule.box.months);
  visit(rule.box.context_classes);
  visit(rule.limits.actions);
  visit(rule.limits.power_permille_max);
}

inline constexpr int kGuardRuleFields = [] {
  int count = 0;
  const GuardRule rule{};
  for_each_field(rule, [&count](std::int32_t) { ++count; });
  return count;
}();

constexpr GuardRule guard_rule_of(const std::int32_t (&row)[kGuardRuleFields]) {
  GuardRule rule;
  const std::int32_t* next = row;
  for_each_field(rule, [&next](auto& field) {
    field = static_cast<std::remove_cvref_t<decltype(field)>>(*next++);
  });
  return rule;
}

/// Limits of all rules at one point; `Rules` is a range of GuardRule.
template <typename Rules>
constexpr RuleLimits rule_limits_at(const Rules& rules, const RulePoint& point) {
  RuleLimits limits;
  for (const GuardRule& rule : rules) {
    if (!rule.box.contains(point)) continue;
    limits.actions = static_cast<ActionSet>(limits.actions & rule.limits.actions);
    if (rule.limits.power_permille_max < limits.power_permille_max) {
      limits.power_permille_max = rule.limits.power_permille_max;
    }
  }
  return limits;
}

/// Power of the nearest allowed action, within the power limit.
constexpr std::int32_t ruled_power_w(const RuleLimits& limits, std::int32_t power_w,
                                     std::int32_t rated_w) {
  const int sign = power_w > 0 ? 1 : power_w < 0 ? -1 : 0;
  const int allowed = power_sign(nearest_allowed(limits.actions, static_cast<Action>(sign + 1)));
  const auto most_w = static_cast<std::int32_t>(std::int64_t{rated_w} * limits.power_permille_max /
                                                kFullPowerPermille);
  return clamp_to(allowed == sign ? power_w : allowed * rated_w, -most_w, most_w);
}

/// Hash of the net's hash and all fields in order; without rules that of the net.
template <typename Rules>
constexpr std::uint32_t ruled_hash(std::uint32_t weights_hash, const Rules& rules) {
  Crc32 crc;
  bool any = false;
  crc.add_integer(static_cast<std::int32_t>(weights_hash));
  for (const GuardRule& rule : rules) {
    any = true;
    for_each_field(rule, [&crc](std::int32_t field) { crc.add_integer(field); });
  }
  return any ? crc.value() : weights_hash;
}

}  // namespace bess
