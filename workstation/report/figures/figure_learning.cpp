// Learning curve of the teacher and losses of the distillation.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "workstation/env/policy.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/figures/figures.h"

namespace bess {
namespace {

/// Step 0 is a residual's alone.
bool begins_as_program(std::span<const CurvePoint> curve) { return curve.front().step == 0; }

std::vector<std::string> learning_rows(const std::vector<CurvePoint>& curve) {
  std::vector<double> profit;
  for (const CurvePoint& p : curve) profit.push_back(p.validation_eur_per_day_per_mwh);
  const std::vector<double> smooth = centred_mean(profit, kSmoothingReach);
  std::vector<std::string> rows;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const std::string loss = curve[i].step == 0 ? "NaN" : fmt::format("{:.6g}", curve[i].loss);
    rows.push_back(fmt::format("{} {:.3f} {:.3f} {}", curve[i].step, profit[i], smooth[i], loss));
  }
  return rows;
}

PictureTable learning_numbers(const std::vector<CurvePoint>& curve, double rule) {
  std::vector<double> profit;
  for (const CurvePoint& p : curve) profit.push_back(p.validation_eur_per_day_per_mwh);
  const std::vector<double> smooth = centred_mean(profit, kSmoothingReach);
  PictureTable table{{},
                     {"step", "validation_eur_per_day_per_mwh", "smoothed_eur_per_day_per_mwh",
                      "rule_eur_per_day_per_mwh", "loss"},
                     {}};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    // At step 0 nothing was learnt: there is no loss.
    table.rows.push_back(
        {fmt::format("{}", curve[i].step), exact(profit[i]), exact(smooth[i]), exact(rule),
         curve[i].step == 0 ? std::string() : fmt::format("{:.9g}", curve[i].loss)});
  }
  return table;
}

struct Range {
  double low, high;
};

/// All validation profits and the rule-based line, with room for their labels.
Range profit_range(const std::vector<CurvePoint>& curve, double rule) {
  const auto [low, high] =
      std::ranges::minmax_element(curve, {}, &CurvePoint::validation_eur_per_day_per_mwh);
  const Range all{std::min(rule, low->validation_eur_per_day_per_mwh),
                  std::max(rule, high->validation_eur_per_day_per_mwh)};
  const double room = 0.14 * std::max(all.high - all.low, 1.0);
  return {all.low - room, all.high + room};
}

double loss_tic(std::span<const CurvePoint> curve) {
  if (begins_as_program(curve) && curve.size() > 1) curve = curve.subspan(1);  // nothing was learnt
  const auto [low, high] = std::ranges::minmax_element(curve, {}, &CurvePoint::loss);
  return tic_distance(high->loss - low->loss, 3);
}

std::string rule_line(double rule) {
  return fmt::format(
      "set arrow 1 from graph 0, first {0} to graph 1, first {0} nohead dt (6,5) lw 1.5 lc {1}\n"
      "set label 1 'rule-based {0:.1f}' at graph 0.99, first {0} right offset 0,0.6 textcolor "
      "{1}\n",
      rule, rgb(kDischarge));
}

/// What the network began as, and was to better.
std::string program_line(const std::vector<CurvePoint>& curve) {
  if (!begins_as_program(curve)) return {};
  return fmt::format(
      "set arrow 3 from graph 0, first {0} to graph 1, first {0} nohead dt (2,3) lw 1.5 lc {1}\n"
      "set label 3 'the program, step 0: {0:.1f}' at graph 0.99, first {0} right offset 0,-0.7 "
      "textcolor {1}\n",
      curve.front().validation_eur_per_day_per_mwh, rgb(kMuted));
}

std::string kept_label(const CurvePoint& kept, bool label_right) {
  return fmt::format(
      "set label 2 'kept: {0:.1f} at step {1}' at {1},{0} {2} offset {3},0.9 textcolor {4} point "
      "pt "
      "7 ps 0.9 lc {4}\n",
      kept.validation_eur_per_day_per_mwh, kept.step, label_right ? "left" : "right",
      label_right ? "-1" : "1", rgb(kInk));
}

std::string profit_panel(const std::vector<CurvePoint>& curve, double rule) {
  const CurvePoint& kept = kept_point(curve);
  const Range range = profit_range(curve, rule);
  return fmt::format(
             "set tmargin at screen 0.925\nset bmargin at screen 0.42\nset yrange [{}:{}]\n"
             "set ylabel \"validation profit,\\nEUR/day/MWh\"\nset format x ''\nset ytics {}\n",
             range.low, range.high, tic_distance(range.high - range.low, 6)) +
         rule_line(rule) + program_line(curve) +
         kept_label(kept, kept.step * 2 < curve.back().step) +
         fmt::format(
             "plot $curve using 1:2 with lines lw 1.5 lc {}, $curve using 1:3 with lines lw 3 lc "
             "{}\n",
             rgb(kSoft), rgb(kCharge));
}

std::string loss_panel(const std::vector<CurvePoint>& curve) {
  return fmt::format(
      "unset arrow\nunset label\n"
      "set tmargin at screen 0.36\nset bmargin at screen 0.14\nset yrange [*:*]\nset ytics {}\n"
      "set format x '%g'\nset xlabel 'gradient steps'\nset ylabel 'loss'\n"
      "plot $curve using 1:4 with lines lw 2 lc {}\n",
      loss_tic(curve), rgb(kMuted));
}

/// Logarithmic axes have no zero: a loss of nothing is left out.
std::string logarithmic(double loss) { return loss > 0 ? fmt::format("{:.6g}", loss) : "NaN"; }

/// Inside sign bounds there is one loss, and nothing left to correct.
Figure regret_figure(const std::vector<DistilPoint>& curve) {
  std::vector<std::string> rows;
  for (const DistilPoint& p : curve) {
    rows.push_back(fmt::format("{} {}", p.epoch, logarithmic(p.visited_loss)));
  }
  Figure figure;
  figure.name = "distillation_curve";
  figure.title = "How the student learned";
  figure.height_px = 360;
  figure.alt = "Line chart with a logarithmic axis: the student's regret over epochs.";
  figure.caption = fmt::format(
      "What the student's choices lose against the teacher's best, over the temperature of its "
      "softmax: {:.3g} at the end. The signs of its weights keep its order, so nothing was left to "
      "correct.",
      curve.back().visited_loss);
  figure.commands = data_block("curve", rows) +
                    fmt::format(
                        "set lmargin at screen 0.115\nset rmargin at screen 0.96\nset logscale y\n"
                        "set xlabel 'epochs'\nset ylabel 'regret / temperature'\n"
                        "plot $curve using 1:2 with lines lw 2.5 lc {}\n",
                        rgb(kCharge));
  figure.numbers = distil_losses_table(figure.name, curve);
  return figure;
}

}  // namespace

double rule_validation_profit(const MarketSteps& market, const BatteryParameters& battery) {
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  EvaluationOptions options;
  options.battery = battery;
  options.carry_soc = true;
  return evaluate(market, market.days_of(Split::kValidation), rule, options)
      .profit_eur_per_day_per_mwh();
}

Figure learning_figure(const std::vector<CurvePoint>& curve, double rule) {
  const CurvePoint& kept = kept_point(curve);
  const double gain = kept.validation_eur_per_day_per_mwh - rule;
  const bool has_program = begins_as_program(curve);
  const double over_program =
      kept.validation_eur_per_day_per_mwh - curve.front().validation_eur_per_day_per_mwh;
  Figure figure;
  figure.name = "learning_curve";
  figure.title = "How the teacher learned";
  figure.height_px = 520;
  figure.alt = fmt::format(
      "Line chart: validation profit over {} gradient steps, raw and smoothed, with the rule-based "
      "controller{} as a dashed line; below it the training loss.",
      curve.back().step, has_program ? " and the program that it began as" : "");
  figure.caption = fmt::format(
      "The teacher is what was learnt by step {}: {:.1f} EUR per day per MWh on the validation "
      "days, {:.1f} {} than the rule-based controller{}. The smoothed line is the mean over up to "
      "two points on either side.",
      kept.step, kept.validation_eur_per_day_per_mwh, std::abs(gain), gain < 0 ? "less" : "more",
      has_program ? fmt::format(", {:.1f} more than the program, its step 0; a later step is kept "
                                "where its gain over that is shown, the days in pairs",
                                over_program)
                  : "");
  const KeyRow key = key_row(figure, 100,
                             {{"each validation", kSoft, KeyEntry::Kind::kLine, 1.5},
                              {"mean of five", kCharge, KeyEntry::Kind::kLine, 3}});
  figure.numbers = learning_numbers(curve, rule);
  figure.commands = data_block("curve", learning_rows(curve)) +
                    fmt::format(
                        "set multiplot\nset lmargin at screen 0.115\n"
                        "set rmargin at screen 0.96\nset xrange [0:{}]\n",
                        curve.back().step) +
                    key.set + profit_panel(curve, rule) + key.unset + loss_panel(curve) +
                    "unset multiplot\n";
  return figure;
}

Figure distillation_figure(const std::vector<DistilPoint>& curve) {
  if (curve.back().is_by_construction()) return regret_figure(curve);
  std::vector<std::string> rows;
  for (const DistilPoint& p : curve) {
    rows.push_back(fmt::format("{} {} {} {}", p.epoch, logarithmic(p.teacher_loss),
                               logarithmic(p.correction_loss), logarithmic(p.visited_loss)));
  }
  Figure figure;
  figure.name = "distillation_curve";
  figure.title = "How the student learned";
  figure.height_px = 360;
  figure.alt =
      "Line chart with a logarithmic axis: three Kullback-Leibler divergences over epochs.";
  figure.caption = fmt::format(
      "Divergence of student and teacher where the teacher goes ({:.3g} nats at the end), of "
      "the student's correction and teacher on the lattices ({:.3g}), and of student and its own "
      "correction ({:.3g}): the last one is what the correction layer still had to change.",
      curve.back().visited_loss, curve.back().teacher_loss, curve.back().correction_loss);
  const KeyRow key =
      key_row(figure, 100,
              {{"its correction to teacher", kSoft, KeyEntry::Kind::kLine, 2},
               {"student to teacher", kCharge, KeyEntry::Kind::kLine, 2.5},
               {"student to its correction", kDischarge, KeyEntry::Kind::kLine, 2.5}});
  figure.commands =
      data_block("curve", rows) + key.set +
      fmt::format(
          "set lmargin at screen 0.115\nset rmargin at screen 0.96\nset tmargin at screen 0.88\n"
          "set logscale y\nset format y '1e%T'\nset ytics 100\nset xlabel 'epochs'\nset ylabel 'KL "
          "divergence, nats'\n"
          "plot $curve using 1:2 with lines lw 2 lc {}, $curve using 1:4 with lines lw 2.5 lc {}, "
          "$curve using 1:3 with lines lw 2.5 lc {}\n",
          rgb(kSoft), rgb(kCharge), rgb(kDischarge));
  figure.numbers = distil_losses_table(figure.name, curve);
  return figure;
}

}  // namespace bess
