// Heat maps: a student as its action at every lattice price and SoC of one month and time of day,
// and a figure over two settings.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "shared/nn/student_net.h"

namespace bess {

// Heat map: means over two settings as a table whose cells are coloured, which can be read aloud,
// copied and printed.

struct HeatPoint {
  std::string across, down;  ///< the values of the two settings; empty: as configured
  double value;              ///< NaN: not known, its place stays empty
};

/// The names of the two settings; `what` is the caption, `id` the table's, once on a page.
struct HeatMapText {
  std::string across, down, what, id;
};

/// Points at the same place become their mean.
std::string heat_map_html(const std::vector<HeatPoint>& points, const HeatMapText& text);

// Where a price regime begins among the days that a picture shows.

/// [place, what changed] of each boundary between two of `dates`, which are ascending.
Json regime_marks(const std::vector<std::string>& dates);

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
