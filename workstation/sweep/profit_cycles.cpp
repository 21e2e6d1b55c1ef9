#include "workstation/sweep/profit_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/host/html_text.h"
#include "workstation/report/figures/figure.h"

namespace bess {
namespace {

constexpr double kWidth = 880, kHeight = 420;
constexpr double kLeft = 70, kRight = 20, kTop = 20, kBottom = 50;
constexpr int kTics = 6;

/// One axis: its range, rounded to whole tics, and where a value stands.
struct Axis {
  double low, high, step;
  double from_px, to_px;

  Axis(double least, double most, double from, double to) : from_px(from), to_px(to) {
    if (!(most > least)) {
      least -= 0.5;
      most += 0.5;
    }
    step = tic_distance(most - least, kTics);
    low = std::floor(least / step) * step;
    high = std::ceil(most / step) * step;
  }
  [[nodiscard]] double px(double value) const {
    return from_px + (to_px - from_px) * (value - low) / (high - low);
  }
  [[nodiscard]] std::string tic_text(double value) const {
    const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step))));
    return html_escaped(with_true_minus(fmt::format("{:.{}f}", value + 0.0, decimals)));
  }
};

std::string grid(const Axis& x, const Axis& y) {
  std::string text;
  for (double at = x.low; at <= x.high + x.step / 2; at += x.step) {
    text += fmt::format(
        "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\" stroke=\"var(--grid)\"/>"
        "<text x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x.px(at), kTop, kHeight - kBottom, kHeight - kBottom + 18, x.tic_text(at));
  }
  for (double at = y.low; at <= y.high + y.step / 2; at += y.step) {
    text += fmt::format(
        "<line x1=\"{1}\" x2=\"{2}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"var(--grid)\"/>"
        "<text x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        y.px(at), kLeft, kWidth - kRight, kLeft - 8, y.px(at) + 4, y.tic_text(at));
  }
  return text;
}

std::string head() {
  return fmt::format(
      "<figure id=\"cycles\"><div class=\"wide\"><svg style=\"max-width:55rem\" viewBox=\"0 0 {0} "
      "{1}\" role=\"img\" "
      "aria-labelledby=\"cycles-title\" font-size=\"13\" fill=\"var(--muted)\">\n"
      "<title id=\"cycles-title\">Profit against cycles of each proved task; the table of tasks "
      "has the numbers</title>\n"
      "<text x=\"{2}\" y=\"{3}\" text-anchor=\"middle\">equivalent full cycles a day</text>\n"
      "<text transform=\"translate(14 {4}) rotate(-90)\" text-anchor=\"middle\">EUR per day per "
      "MWh</text>\n",
      kWidth, kHeight, (kLeft + kWidth - kRight) / 2, kHeight - 8, (kTop + kHeight - kBottom) / 2);
}

}  // namespace

std::string profit_cycles_svg(const std::vector<CollectedTask>& tasks) {
  std::vector<const CollectedTask*> shown;
  for (const CollectedTask& task : tasks) {
    if (task.figures) shown.push_back(&task);
  }
  if (shown.empty()) return {};
  const auto cycles = [](const CollectedTask* task) { return task->figures->cycles_per_day; };
  const auto profit = [](const CollectedTask* task) { return task->figures->profit; };
  const auto [least_x, most_x] = std::ranges::minmax_element(shown, {}, cycles);
  const auto [least_y, most_y] = std::ranges::minmax_element(shown, {}, profit);
  const Axis x(cycles(*least_x), cycles(*most_x), kLeft, kWidth - kRight);
  const Axis y(profit(*least_y), profit(*most_y), kHeight - kBottom, kTop);
  std::string text = head() + grid(x, y) + "<g fill=\"var(--charge)\" fill-opacity=\".6\">\n";
  for (const CollectedTask* task : shown) {
    text += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"><title>task {}: {}</title></circle>\n",
        x.px(cycles(task)), y.px(profit(task)), task->task.number,
        html_escaped(settings_shown(task->task.settings)));
  }
  return text +
         "</g>\n</svg></div><figcaption>Profit against cycles, a dot a proved task: higher at the "
         "same place earns more for the same wear.</figcaption></figure>\n";
}

}  // namespace bess
