#include "edge/page/svg.h"

#include <algorithm>
#include <cmath>

#include "shared/host/text.h"

namespace bess {

double Scale::inside(double value) const { return at(std::clamp(value, low, high)); }

std::vector<double> round_ticks(double low, double high, int count_max) {
  std::vector<double> ticks;
  if (!(high > low)) return ticks;
  double step = std::pow(10, std::floor(std::log10((high - low) / count_max)));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (std::floor(high / (step * factor)) - std::ceil(low / (step * factor)) + 1 <= count_max) {
      step *= factor;
      break;
    }
  }
  for (double k = std::ceil(low / step); k * step <= high; ++k) ticks.push_back(k * step + 0.0);
  return ticks;
}

std::string place(double x, double y) { return formatted("%.1f,%.1f ", x, y); }

std::string svg_text(double x, double y, const char* anchor, const std::string& text) {
  return formatted("<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor) + text +
         "</text>\n";
}

std::string svg_line(double x1, double y1, double x2, double y2, const char* css_class) {
  return formatted("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" class=\"%s\"/>\n", x1, y1,
                   x2, y2, css_class);
}

std::string horizontal_grid(const Scale& y, double left, double right, int count_max) {
  std::string text;
  for (const double tick : round_ticks(y.low, y.high, count_max)) {
    text += svg_line(left, y.at(tick), right, y.at(tick), tick == 0 ? "zero" : "grid");
    text += svg_text(left - 6, y.at(tick) + 4, "end", formatted("%g", tick));
  }
  return text;
}

}  // namespace bess
