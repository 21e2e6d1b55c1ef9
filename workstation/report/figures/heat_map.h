// Heat map: means over two settings as a table whose cells are coloured, which can be read aloud,
// copied and printed.
#pragma once

#include <string>
#include <vector>

namespace bess {

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

}  // namespace bess
