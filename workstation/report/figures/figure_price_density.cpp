// How the observed prices of training and test days are distributed.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "workstation/market/statistics/market_statistics.h"
#include "workstation/report/figures/figures.h"
#include "workstation/report/figures/price_histogram.h"

namespace bess {
namespace {

/// "left edge, % of decisions in the bin", for steps.
std::string histogram_data(const std::string& name, const std::vector<double>& sorted,
                           const PriceHistogram& shown) {
  std::vector<std::string> rows;
  double edge = shown.low;
  for (const double percent : shown.percent_by_bin(sorted)) {
    rows.push_back(fmt::format("{} {:.4f}", edge, percent));
    edge += kPriceBinEurPerMwh;
  }
  return data_block(name, rows);
}

double share_below(const std::vector<double>& sorted, double price) {
  if (sorted.empty()) return 0;
  return static_cast<double>(std::ranges::lower_bound(sorted, price) - sorted.begin()) /
         static_cast<double>(sorted.size());
}

struct Line {
  double price;
  std::string text;
  bool charges;   ///< acts to the left of the line
  double height;  ///< of its text, graph units
};

std::string threshold_line(const Line& line, int tag) {
  const Colour& colour = line.charges ? kCharge : kDischarge;
  return fmt::format(
      "set arrow {0} from first {1}, graph 0 to first {1}, graph 1 nohead front dt (6,5) lw 1.5 lc "
      "{2}\nset label {0} {3} at first {1}, graph {4} {5} offset {6},0 front textcolor {2}\n",
      tag, line.price, rgb(colour), "'" + line.text + "'", line.height,
      line.charges ? "right" : "left", line.charges ? "-0.7" : "0.7");
}

std::string threshold_lines(const PriceThresholds& student, const PriceHistogram& shown) {
  const int low = student.low_eur_per_mwh;
  const int high = student.high_eur_per_mwh;
  const Line lines[] = {
      {kPaperRuleLowEurPerMwh, fmt::format("rule-based charges below {:g}", kPaperRuleLowEurPerMwh),
       true, 0.95},
      {kPaperRuleHighEurPerMwh,
       fmt::format("rule-based discharges above {:g}", kPaperRuleHighEurPerMwh), false, 0.95},
      {static_cast<double>(low), fmt::format("must charge up to {}", low), true, 0.84},
      {static_cast<double>(high), fmt::format("must discharge from {}", high), false, 0.84}};
  std::string text;
  int tag = 1;
  for (const Line& line : lines) {
    if (line.price > shown.low && line.price < shown.high) text += threshold_line(line, tag);
    ++tag;
  }
  return text;
}

std::string caption_of(const PriceThresholds& student, const PriceHistogram& shown) {
  const auto& [train, test, low, high] = shown;
  if (train.empty() || test.empty()) return "One of the two splits has no days.";
  const auto percent = [](double share) { return 100 * share; };
  return fmt::format(
      "Half of the prices lie between {:.0f} and {:.0f} EUR/MWh on training days and between "
      "{:.0f} "
      "and {:.0f} on test days; {:.1f} % and {:.1f} % are negative. {:.1f} % of the test prices "
      "lie "
      "outside the range shown. The student must charge up to {} and discharge from {} EUR/MWh.",
      quantile_of_sorted(train, 0.25), quantile_of_sorted(train, 0.75),
      quantile_of_sorted(test, 0.25), quantile_of_sorted(test, 0.75),
      percent(share_below(train, 0)), percent(share_below(test, 0)),
      percent(share_below(test, low) + 1 - share_below(test, high)), student.low_eur_per_mwh,
      student.high_eur_per_mwh);
}

}  // namespace

Figure price_density_figure(const MarketSteps& market, const PriceThresholds& student) {
  const PriceHistogram shown = price_histogram(market);
  Figure figure;
  figure.name = "price_density";
  figure.title = "Prices of training and test days";
  figure.height_px = 400;
  figure.alt = fmt::format(
      "Histogram of observed prices from {:.0f} to {:.0f} EUR/MWh, training days as an area, test "
      "days as a line, thresholds as dashed lines.",
      shown.low, shown.high);
  figure.caption = caption_of(student, shown);
  figure.numbers = histogram_table(figure.name, shown);
  const KeyRow key = key_row(figure, 84,
                             {{"training days", kSoft, KeyEntry::Kind::kArea, 0, 0.7},
                              {"test days", kInk, KeyEntry::Kind::kLine, 2}});
  figure.commands =
      histogram_data("train", shown.train, shown) + histogram_data("test", shown.test, shown) +
      threshold_lines(student, shown) + key.set +
      fmt::format(
          "set lmargin at screen 0.095\nset rmargin at screen 0.96\nset tmargin at screen 0.89\n"
          "set xrange [{}:{}]\nset yrange [0:*]\nset offsets graph 0,0,0.22,0\n"
          "set xlabel 'observed (indicative) price, EUR/MWh'\n"
          "set ylabel '% of decisions per {:g} EUR/MWh'\n"
          "plot $train using 1:2 with fillsteps fc {} fs solid 0.7, "
          "$test using 1:2 with steps lw 2 lc {}\n",
          shown.low, shown.high, kPriceBinEurPerMwh, rgb(kSoft), rgb(kInk));
  return figure;
}

}  // namespace bess
