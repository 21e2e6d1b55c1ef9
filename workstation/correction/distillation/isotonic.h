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
#pragma once

#include <span>
#include <vector>

namespace bess {

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

}  // namespace bess
