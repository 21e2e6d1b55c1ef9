// Differentiable optimisation layer [Paper, Eq. 11]: maps the student's logits on one context
// lattice (all prices x SoCs for one T_qh, qh, mo) to the nearest logits that satisfy the
// properties.
//
// Logit differences u = z_charge - z_idle and v = z_idle - z_discharge are projected separately;
// the mean of the logits is unchanged [SPEC 5]:
//   monotone (3):     u, v fall by at least a slope margin per step of price and of SoC
//   price <= low (1): u >= m and v >= 0          price >= high (2): v <= -m and u <= 0
// The slope margin keeps the order in the integer student despite rounding. It is a change of
// variables: x = u + ramp is non-increasing if u falls at least as fast as the ramp rises.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "shared/price_thresholds.h"

namespace bess {

// Exact projection onto matrices that do not increase along rows or columns, with bounds on the
// first and last rows: property 3 with properties 1 and 2 [Paper, Eq. 11; SPEC 5].
//
//   x = argmin sum_ij (x_ij - y_ij)^2
//   s.t. x_ij >= x_i+1,j   x_ij >= x_i,j+1          rows: price ascending, columns: SoC ascending
//        x_ij >= lower  for rows i < lower_rows     x_ij <= upper  for the last upper_rows rows
//
// Threshold decomposition of a separable convex problem: for any level theta the set {x > theta} is
// a maximum-weight staircase for the weights y - theta, where bounded rows are forced in below
// their lower bound and out above their upper bound. The two sides are then independent [Hochbaum
// 2001; Stout 2013]. First split at theta = lower and theta = upper, with rows forced. Inside each
// part the bound is equal for all cells, so clipping the unbounded solution is exact. The unbounded
// solution splits at the mean until no staircase gains. Clipping without the forced splits is not
// the projection.
//
// Adjoint: the solution is piecewise linear in y. The Jacobian averages over each level set and is
// zero where the level set is clipped to a bound.

/// Bounds on whole rows. Requires lower > upper if both are in force (they bound opposite ends).
struct RowBounds {
  int lower_rows = 0;  ///< rows 0 .. lower_rows-1 are at least `lower`
  double lower = 0;
  int upper_rows = 0;  ///< the last upper_rows rows are at most `upper`
  double upper = 0;
};

class IsotonicProjection {
 public:
  IsotonicProjection(int rows, int columns);

  /// x = projection of y; both [rows x columns], row-major. Remembers the level sets for
  /// backward().
  void project(std::span<const double> y, const RowBounds& bounds, std::span<double> x);
  /// dL/dy from dL/dx at the last projection; may alias.
  void backward(std::span<const double> gradient_x, std::span<double> gradient_y) const;

 private:
  /// Cells begin[i] <= j < end[i] of each row; clip range of the solution inside.
  struct Block {
    std::vector<int> begin, end;
    double clip_low, clip_high;
  };
  struct Rows {
    int first, last;  ///< rows that hold cells of the block, last exclusive
  };
  [[nodiscard]] Rows rows_of(const Block& block) const;
  double best_staircase(const Block& block, Rows rows, double theta, int forced_in_rows,
                        int forced_out_rows, std::vector<int>& cut);
  void split(const Block& block, const std::vector<int>& cut, Block& above, Block& below) const;
  void solve(Block whole);
  void finish_level_set(const Block& block, Rows rows, double mean);

  int rows_;
  int columns_;
  std::span<const double> y_;
  std::span<double> x_;
  std::vector<double> best_;    ///< [row][threshold 0..columns] best weight of rows up to this one
  std::vector<int> argbest_;    ///< threshold of the row before that attains it
  std::vector<int> level_set_;  ///< [cell]
  std::vector<char> clipped_;   ///< [level set]
};

struct CorrectionOptions {
  PriceThresholds thresholds = {};  ///< of properties 1 and 2
  double logit_margin = 1.0;        ///< m
  double price_slope = 0.2;         ///< logits over the whole mapped price range
  double soc_slope = 0.4;           ///< logits over the whole SoC range
};

/// Axes of one lattice, ascending: prices in EUR/MWh with their network input, SoC as network input
/// 0..1.
struct LatticeAxes {
  std::vector<int> price_eur_per_mwh;
  std::vector<double> mapped_price;
  std::vector<double> soc;
};

/// Bounds on x = difference + ramp for a difference that must be at least `lower` at prices <= low
/// and at most `upper` at prices >= high. The ramp varies within a row, so the strictest cell of
/// the row sets the bound.
RowBounds ramped_bounds(const CorrectionOptions& options, const LatticeAxes& axes, double lower,
                        double upper);

class CorrectionLayer {
 public:
  CorrectionLayer(const CorrectionOptions& options, int prices, int socs);

  /// Corrects logits [3 x prices*socs] (column = price index * socs + SoC index) in double.
  void forward(const LatticeAxes& axes, const Eigen::MatrixXd& logits, Eigen::MatrixXd& corrected);
  /// dL/dlogits from dL/dcorrected for the last forward.
  void backward(const Eigen::MatrixXd& gradient_corrected, Eigen::MatrixXd& gradient_logits);

  [[nodiscard]] const CorrectionOptions& options() const { return options_; }

 private:
  void project(const LatticeAxes& axes, IsotonicProjection& projection, const RowBounds& bounds,
               std::vector<double>& difference);

  CorrectionOptions options_;
  int prices_;
  int socs_;
  IsotonicProjection projection_u_;
  IsotonicProjection projection_v_;
  std::vector<double> u_, v_, shifted_;
};

}  // namespace bess
