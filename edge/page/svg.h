// Axes and paths of the page's pictures: a scale from values to places, round ticks, and text that
// never needs a browser's arithmetic.
#pragma once

#include <string>
#include <vector>

namespace bess {

/// From `low`..`high` to `from`..`to` of the picture, in its own units.
struct Scale {
  double low = 0;
  double high = 1;
  double from = 0;
  double to = 1;

  [[nodiscard]] double at(double value) const {
    return from + (to - from) * (value - low) / (high - low);
  }
  /// Values beyond the ends stay at them.
  [[nodiscard]] double inside(double value) const;
};

/// Multiples of 1, 2 or 5 times a power of ten from `low` to `high`, `count_max` at most, two at
/// least where there are.
std::vector<double> round_ticks(double low, double high, int count_max);

/// "12.3,45.6 ": a place of a path.
std::string place(double x, double y);

/// Text at a place; `anchor` is start, middle or end.
std::string svg_text(double x, double y, const char* anchor, const std::string& text);
std::string svg_line(double x1, double y1, double x2, double y2, const char* css_class);

/// Lines across a plot with their labels to the left.
std::string horizontal_grid(const Scale& y, double left, double right, int count_max);

}  // namespace bess
