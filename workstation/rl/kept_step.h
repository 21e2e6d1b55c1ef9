// Which step of a training becomes the teacher. A network alone: the one that earned most on the
// validation days. A residual begins, at step 0, as the stochastic program, and the best of a dozen
// looks at twenty days is mostly the luckiest: a later step is kept only where its gain over the
// program is shown (workstation/README.md, "A seed never costs").
//
// Shown is a gain, the days in pairs, beyond its interval (env/day_errors.h: the wider of the plain
// one and the one by month, by Student's t). Each of n looks may be wrong by chance in one case of
// 20 n, so that all together are in at most one of 20 [Bonferroni; Dunn 1961].
#pragma once

#include <span>
#include <vector>

#include "workstation/env/evaluate.h"

namespace bess {

/// A look at the validation days.
struct CurvePoint {
  long step;
  double loss;
  double validation_eur_per_day_per_mwh;
  double edge_mass_frac;  ///< target mass on the two end atoms; above 1 % the support is too narrow
  /// Of a residual: lower end of the interval of its gain over step 0. 0 at step 0 and of a network
  /// alone.
  double gain_at_least_eur_per_day_per_mwh = 0;
};

/// Lower end of the interval of the gain of `earned` over a program that earned `program_eur` on
/// the same days, at one of `looks` looks. Of a single day that is far below any gain.
double gain_at_least_eur_per_day_per_mwh(const Evaluation& earned,
                                         std::span<const double> program_eur, long looks);

/// The point whose weights are the teacher; of equals the first. `curve` is not empty.
const CurvePoint& kept_point(const std::vector<CurvePoint>& curve);

}  // namespace bess
