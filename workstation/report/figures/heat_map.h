// Heat map of a result over two settings, and starts of price regimes in a picture.
#pragma once

#include <string>
#include <vector>

#include "shared/host/json.h"

namespace bess {

// Heat map over two numeric settings, as an accessible table with coloured cells.

struct HeatValue {
  double value, error;  ///< standard error; NaN: unknown
};

/// Value of a cell's colour: 0 within two standard errors of zero, or without an error; `left`, the
/// shade of the cell to its left, within two standard errors of it; else its own.
HeatValue shade_of(const HeatValue& cell, const HeatValue& left);

struct HeatPoint {
  std::string across, down;  ///< values of the two settings
  HeatValue of;              ///< an unknown value is shown empty
};

inline constexpr const char* kShadeMeaning =
    "pale: within two standard errors of zero; equal shade: within two of the cell to the left";

/// Names of the two settings; `what` is the caption, `id` the unique id of the table.
struct HeatMapText {
  std::string across, down, what, id;
};

std::string heat_map_html(const std::vector<HeatPoint>& points, const HeatMapText& text);

// Starts of price regimes within the days of a picture.

/// [index, change] of each boundary within `dates`, which are ascending.
Json regime_marks(const std::vector<std::string>& dates);

}  // namespace bess
