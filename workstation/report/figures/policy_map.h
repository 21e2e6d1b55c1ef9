// A student seen as a map: its action at every lattice price and SoC of one month and time of day.
#pragma once

#include <compare>
#include <cstdint>
#include <vector>

#include "shared/nn/student_net.h"

namespace bess {

/// The part of a state that stays fixed over one map.
struct PolicyContext {
  int context_class;           ///< 1..12
  int quarter_hour;            ///< local, 0..95
  int minute_of_quarter_hour;  ///< minute of the quarter-hour, 0..14
  friend auto operator<=>(const PolicyContext&, const PolicyContext&) = default;
};

/// Action's integers, [SoC index][price index], kSocCount x kPriceCount.
using ActionGrid = std::vector<std::int8_t>;

ActionGrid student_grid(const StudentNet& net, const PolicyContext& context);

}  // namespace bess
