// Context classes: the student's third input, one of twelve [SPEC 4]. `month`: local month as in
// the paper, which memorises the price level of the training year. `level`: class of the trailing
// price level (price_level.h), valid in other years. `outlook`: class of the break-even price of a
// plan on day-ahead prices (outlook/outlook_plan.h). The proof covers all twelve.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/units_and_limits.h"

namespace bess {

enum class ContextKind : std::uint8_t { kMonth, kLevel, kOutlook };
inline constexpr ContextKind kContextKinds[] = {ContextKind::kMonth, ContextKind::kLevel,
                                                ContextKind::kOutlook};

constexpr std::string_view context_name(ContextKind kind) {
  constexpr std::string_view kNames[] = {"month", "level", "outlook"};
  return kNames[static_cast<int>(kind)];
}

struct ContextClasses {
  ContextKind kind = ContextKind::kMonth;
  /// Level and outlook: class c + 1 begins at edge c - 1, EUR/MWh, strictly ascending. Month: all
  /// 0.
  std::int16_t level_edge_eur_per_mwh[kContextClassCount - 1] = {};

  [[nodiscard]] constexpr bool is_outlook() const { return kind == ContextKind::kOutlook; }

  /// 1..12, from the month, or from the level or break-even price in hundredths of EUR/MWh.
  [[nodiscard]] constexpr std::int16_t class_of(int month, std::int32_t price_centi) const {
    if (kind == ContextKind::kMonth) return static_cast<std::int16_t>(month);
    std::int16_t found = 1;
    for (const std::int16_t edge : level_edge_eur_per_mwh) {
      if (price_centi >= edge * kCentiPerEur) ++found;
    }
    return found;
  }

  [[nodiscard]] constexpr bool is_valid() const {
    for (int i = 0; i + 1 < kContextClassCount - 1; ++i) {
      const int rise = level_edge_eur_per_mwh[i + 1] - level_edge_eur_per_mwh[i];
      if (kind == ContextKind::kMonth ? rise != 0 : rise <= 0) return false;
    }
    return kind != ContextKind::kMonth || level_edge_eur_per_mwh[0] == 0;
  }
  friend constexpr bool operator==(const ContextClasses&, const ContextClasses&) = default;
};

}  // namespace bess
