// What a larger omega costs and brings: three panels over one logarithmic axis.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "workstation/report/figures/omega_sweep.h"

namespace bess {
namespace {

/// A logarithmic axis has no zero: this is where none is drawn, below a single violation.
constexpr double kNone = 0.3;

double shown_count(std::int64_t violations) {
  return violations > 0 ? static_cast<double>(violations) : kNone;
}

std::vector<std::string> rows_of(const std::vector<OmegaPoint>& points, const Evaluation& teacher) {
  std::vector<std::string> rows;
  for (const OmegaPoint& p : points) {
    const PairedDifference gain = paired_difference(p.evaluation, teacher);
    rows.push_back(fmt::format("{:g} {:g} {:g} {:g} {:.4f} {:.4f} {:.4f}", p.omega,
                               shown_count(p.certificate.violations_of(1)),
                               shown_count(p.certificate.violations_of(2)),
                               shown_count(p.certificate.violations_of(3)), 100 * p.agreement,
                               gain.mean, gain.standard_error));
  }
  return rows;
}

std::string violations_panel() {
  return fmt::format(
      "set tmargin at screen 0.925\nset bmargin at screen 0.60\nset logscale y\n"
      "set yrange [{0}:*]\nset format x ''\nset ylabel 'violations'\n"
      "set ytics ('none' {0}, '1' 1, '1e3' 1e3, '1e6' 1e6, '1e9' 1e9)\n"
      "plot $sweep using 1:4 with linespoints lw 2.5 pt 7 ps 0.6 lc {1}, "
      "$sweep using 1:2 with linespoints lw 2 pt 7 ps 0.6 lc {2}, "
      "$sweep using 1:3 with linespoints lw 2 dt 2 pt 6 ps 0.8 lc {3}\n",
      kNone, rgb(kInk), rgb(kCharge), rgb(kDischarge));
}

/// Between tics of a low panel; of equal values gnuplot draws a range about them.
double few_tics(double low, double high) { return tic_distance(std::max(high - low, 1.0), 4); }

std::string agreement_panel(const std::vector<OmegaPoint>& points) {
  const auto& [least, most] = std::ranges::minmax(points, {}, &OmegaPoint::agreement);
  return fmt::format(
      "set tmargin at screen 0.575\nset bmargin at screen 0.37\nunset logscale y\n"
      "set yrange [*:*]\nset ytics auto\nset ytics {}\nset ylabel 'agreement, %'\n"
      "plot $sweep using 1:5 with linespoints lw 2.5 pt 7 ps 0.6 lc {}\n",
      few_tics(100 * least.agreement, 100 * most.agreement), rgb(kInk));
}

std::string gain_panel(const std::vector<OmegaPoint>& points, const Evaluation& teacher) {
  std::vector<double> ends;
  for (const OmegaPoint& p : points) {
    const PairedDifference gain = paired_difference(p.evaluation, teacher);
    const double reach = std::isnan(gain.standard_error) ? 0 : gain.standard_error;
    ends.insert(ends.end(), {gain.mean - reach, gain.mean + reach});
  }
  const auto [low, high] = std::ranges::minmax(ends);
  return fmt::format(
      "set tmargin at screen 0.345\nset bmargin at screen 0.13\nset ylabel 'gain, "
      "EUR/day'\nset ytics {2}\n"
      "set format x '1e%T'\nset xlabel 'omega'\nset xzeroaxis lt 1 lw 1 lc {0}\n"
      "plot $sweep using 1:6:7 with yerrorbars lw 1.5 pt 7 ps 0.6 lc {1}, "
      "$sweep using 1:6 with lines lw 2 lc {1}\n",
      rgb(kMuted), rgb(kInk), few_tics(low, high));
}

}  // namespace

Figure omega_figure(const std::vector<OmegaPoint>& points, const Evaluation& teacher) {
  const auto& [least, most] = std::ranges::minmax(points, {}, &OmegaPoint::omega);
  Figure figure;
  figure.name = "omega_sweep";
  figure.title = "Following the teacher or the properties";
  figure.height_px = 620;
  figure.alt =
      "Three line charts over a logarithmic omega: violations of the three properties, agreement "
      "with the teacher, and profit above the teacher's with standard errors.";
  figure.caption = fmt::format(
      "Before repair, at omega {:g} a student agrees with {:.1f} % of the teacher's decisions and "
      "violates properties at {} states and pairs; at omega {:g} it is {:.1f} % and {}. Gain in "
      "EUR "
      "per day per MWh, paired by day.",
      least.omega, 100 * least.agreement, least.certificate.violations(), most.omega,
      100 * most.agreement, most.certificate.violations());
  const KeyRow key = key_row(figure, 100,
                             {{"1: cheap, charge", kCharge, KeyEntry::Kind::kLine, 2},
                              {"2: dear, discharge", kDischarge, KeyEntry::Kind::kLine, 2},
                              {"3: monotone", kInk, KeyEntry::Kind::kLine, 2.5}});
  figure.commands = data_block("sweep", rows_of(points, teacher)) +
                    fmt::format(
                        "set multiplot\nset lmargin at screen 0.13\nset rmargin at screen 0.96\n"
                        "set logscale x\nset xrange [{:g}:{:g}]\n",
                        least.omega / 1.5, most.omega * 1.5) +
                    key.set + violations_panel() + key.unset + agreement_panel(points) +
                    gain_panel(points, teacher) + "unset multiplot\n";
  return figure;
}

}  // namespace bess
