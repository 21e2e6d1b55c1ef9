#include "workstation/market/statistics/statistics_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "shared/host/file.h"
#include "shared/host/gnuplot.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/base/palette.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr int kBinEurPerMwh = 20;
constexpr double kShownMinEurPerMwh = -600;
constexpr double kShownMaxEurPerMwh = 1000;

/// On light or on dark paper.
using Shade = std::string_view Colour::*;

std::string_view terminal_for(const fs::path& path) {
  if (path.extension() == ".svg") return "svg size 900,700 dynamic noenhanced";
  if (path.extension() == ".png") return "pngcairo size 900,700 noenhanced";
  fail("{}: a picture is .svg or .png; rename it", path.string());
}

std::string true_minus(double value) {
  return fmt::format("{}{}", value < 0 ? "\u2212" : "", std::abs(value));
}

struct PriceBins {
  std::string data;  ///< share of all quarter-hours by price bin, in percent per bin
  std::string axis;  ///< label: what is shown, and what lies beyond
};

PriceBins price_bins(std::span<const double> settled) {
  std::map<int, int> bins;
  int count = 0;
  std::vector<double> beyond;
  for (const double price : settled) {
    if (!is_published(price)) continue;
    ++count;
    if (price < kShownMinEurPerMwh || price > kShownMaxEurPerMwh) {
      beyond.push_back(price);
    } else {
      ++bins[static_cast<int>(std::floor(price / kBinEurPerMwh))];
    }
  }
  PriceBins result;
  for (const auto& [bin, hits] : bins) {
    result.data += fmt::format("{} {:.4f}\n", (bin + 0.5) * kBinEurPerMwh, 100.0 * hits / count);
  }
  result.axis = "settled price, EUR/MWh (\u2212600 to 1000 shown";
  if (!beyond.empty()) {
    const auto [least, most] = std::ranges::minmax(beyond);
    result.axis += fmt::format("; {} beyond, {} to {}", counted(beyond.size(), "quarter-hour"),
                               true_minus(least), true_minus(most));
  }
  result.axis += ")";
  return result;
}

std::string convergence_data(const ConvergenceByMinute& convergence) {
  std::string data;
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    if (convergence[m].count == 0) continue;
    data += fmt::format("{} {:.3f} {:.3f}\n", m, convergence[m].median_error,
                        convergence[m].mean_error);
  }
  return data;
}

/// The look of every figure (report/figure.cpp).
std::string style(Shade shade) {
  return fmt::format(
      "set encoding utf8\nset minussign\nset border 3 lw 1 lc rgb '{0}'\n"
      "set tics nomirror out scale 0.5 textcolor rgb '{0}'\nset title textcolor rgb '{0}'\n"
      "set xlabel textcolor rgb '{0}'\nset ylabel textcolor rgb '{0}'\n"
      "set key top right textcolor rgb '{0}'\nset grid lt 1 lw 1 lc rgb '{1}'\n"
      "set style fill solid noborder\n",
      kInk.*shade, kGridLine.*shade);
}

/// The commands and inline data that gnuplot is fed; the name of `picture` says the format.
std::string gnuplot_script(const fs::path& picture, const fs::path& output, Shade shade,
                           const MarketStatistics& statistics, std::span<const double> settled) {
  const std::string convergence =
      statistics.convergence ? convergence_data(*statistics.convergence) : std::string();
  const PriceBins bins = price_bins(settled);
  std::string script =
      fmt::format("set terminal {} background '{}'\nset output {}\n{}$prices << EOD\n{}EOD\n",
                  terminal_for(picture), kPaper.*shade, gnuplot_quoted(output.string()),
                  style(shade), bins.data);
  if (!convergence.empty()) script += fmt::format("$errors << EOD\n{}EOD\n", convergence);
  script += fmt::format(
      "set multiplot layout {},1\nset xlabel '{}'\n"
      "set ylabel '% of quarter-hours'\nset title 'Imbalance prices {} to {}'\n"
      "plot $prices using 1:2 with boxes lc rgb '{}' notitle\n",
      convergence.empty() ? 1 : 2, bins.axis, utc_text(statistics.from_utc_s).view(),
      utc_text(statistics.until_utc_s).view(), kSoft.*shade);
  if (!convergence.empty()) {
    script += fmt::format(
        "set title 'Indicative against settled price'\nset xlabel 'minute of the quarter-hour'\n"
        "set ylabel 'absolute error, EUR/MWh'\nset yrange [0:*]\n"
        "plot $errors using 1:2 with linespoints pt 7 lw 2 lc rgb '{}' title 'median', "
        "$errors using 1:3 with linespoints pt 5 lw 2 lc rgb '{}' title 'mean'\n",
        kCharge.*shade, kDischarge.*shade);
  }
  return script + "unset multiplot\n";
}

}  // namespace

void require_drawable(const fs::path& path) {
  (void)terminal_for(path);
  require_writable(path);
}

void plot_statistics(const fs::path& path, const MarketStatistics& statistics,
                     std::span<const double> settled) {
  require_drawable(path);
  if (price_bins(settled).data.empty()) {
    fail("{}: nothing to draw: no settled price from {} to {} EUR/MWh", path.string(),
         kShownMinEurPerMwh, kShownMaxEurPerMwh);
  }
  fs::path dark = path;
  dark.replace_filename(path.stem().string() + "_dark" + path.extension().string());
  for (const auto& [picture, shade] :
       {std::pair(path, &Colour::light), std::pair(dark, &Colour::dark)}) {
    draw_with_gnuplot(picture, [&](const fs::path& output) {
      return gnuplot_script(picture, output, shade, statistics, settled);
    });
  }
}

}  // namespace bess
