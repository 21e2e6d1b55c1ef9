// The student's third input [SPEC 4]: one of twelve context classes. By `month` it is the paper's
// local month, which learns the level of the training year's prices by heart; by `level` it is the
// class of the trailing price level (price_level.h), which holds in another year; by `outlook` it
// is the class of the break-even price that a plan on day-ahead prices has for this moment and SoC
// (outlook/outlook_plan.h). The proof covers all twelve in each case.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/units_and_limits.h"

namespace bess {

enum class ContextKind : std::uint8_t { kMonth, kLevel, kOutlook };
inline constexpr ContextKind kContextKinds[] = {ContextKind::kMonth, ContextKind::kLevel,
                                                ContextKind::kOutlook};

constexpr std::string_view context_name(ContextKind kind) {
  switch (kind) {
    case ContextKind::kMonth:
      return "month";
    case ContextKind::kLevel:
      return "level";
    case ContextKind::kOutlook:
      break;
  }
  return "outlook";
}

struct ContextClasses {
  ContextKind kind = ContextKind::kMonth;
  /// By level or outlook: class c + 1 begins at edge c - 1, EUR/MWh, ascending strictly. By month:
  /// all 0.
  std::int16_t level_edge_eur_per_mwh[kContextClassCount - 1] = {};

  [[nodiscard]] constexpr bool is_outlook() const { return kind == ContextKind::kOutlook; }

  /// 1..12, of the month, or of the trailing level or the break-even price, in hundredths of
  /// EUR/MWh, whichever is the context.
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
