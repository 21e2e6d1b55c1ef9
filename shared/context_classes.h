// The student's third input [SPEC 4]: one of twelve context classes. By `month` it is the paper's
// local month, which learns the level of the training year's prices by heart; by `level` it is the
// class of the trailing price level (price_level.h), which holds in another year. The proof covers
// all twelve either way.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/units_and_limits.h"

namespace bess {

enum class ContextKind : std::uint8_t { kMonth, kLevel };

constexpr std::string_view context_name(ContextKind kind) {
  return kind == ContextKind::kMonth ? "month" : "level";
}

struct ContextClasses {
  ContextKind kind = ContextKind::kMonth;
  /// By level: class c + 1 begins at edge c - 1, EUR/MWh, ascending strictly. By month: all 0.
  std::int16_t level_edge_eur_per_mwh[kContextClassCount - 1] = {};

  /// 1..12. The level is in hundredths of EUR/MWh and counts only where it is the context.
  [[nodiscard]] constexpr std::int16_t class_of(int month,
                                                std::int32_t level_centi_eur_per_mwh) const {
    if (kind == ContextKind::kMonth) return static_cast<std::int16_t>(month);
    std::int16_t found = 1;
    for (const std::int16_t edge : level_edge_eur_per_mwh) {
      if (level_centi_eur_per_mwh >= edge * kCentiPerEur) ++found;
    }
    return found;
  }

  [[nodiscard]] constexpr bool is_valid() const {
    for (int i = 0; i + 1 < kContextClassCount - 1; ++i) {
      const int rise = level_edge_eur_per_mwh[i + 1] - level_edge_eur_per_mwh[i];
      if (kind == ContextKind::kLevel ? rise <= 0 : rise != 0) return false;
    }
    return kind == ContextKind::kLevel || level_edge_eur_per_mwh[0] == 0;
  }
  friend constexpr bool operator==(const ContextClasses&, const ContextClasses&) = default;
};

}  // namespace bess
