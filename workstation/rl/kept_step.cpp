#include "workstation/rl/kept_step.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

constexpr double kFarBelow = -1e300;

}  // namespace

double gain_at_least_eur_per_day_per_mwh(const Evaluation& earned,
                                         std::span<const double> program_eur, long looks) {
  Evaluation program = earned;
  for (std::size_t d = 0; d < program.days.size(); ++d) {
    program.days[d].profit_eur = program_eur[d];
  }
  const PairedDifference gain = paired_difference(earned, program);
  const double coverage = 1 - (1 - kShownCoverage) / static_cast<double>(looks);
  const double half_width = interval_half_width(gain.errors(), coverage);
  return std::isnan(half_width) ? kFarBelow : gain.mean - half_width;
}

const CurvePoint& kept_point(const std::vector<CurvePoint>& curve) {
  const auto earned_if_shown = [](const CurvePoint& point) {
    return point.gain_at_least_eur_per_day_per_mwh < 0 ? kFarBelow
                                                       : point.validation_eur_per_day_per_mwh;
  };
  return *std::ranges::max_element(curve, {}, earned_if_shown);
}

}  // namespace bess
