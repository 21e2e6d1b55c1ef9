// Projection onto linear constraints, a quadratic program that is dense in the variables and sparse
// in the rows, with its derivative:
//
//   x = argmin 1/2 |x - g|^2   s.t.  a_i'x >= b_i
//
// Dual active-set method [Goldfarb, Idnani 1983, Mathematical Programming 27]: starts at the
// unconstrained minimum g and adds the most violated row, dropping active rows whose
// multipliers would become negative, until none is violated. Each step raises the dual value, so it
// terminates. A row that depends on the active ones takes a step in the multipliers only. If no
// step is possible, no x satisfies all rows, and the multipliers name the contradicting rows
// (Farkas). At the end x and multipliers are recomputed from the factors, which removes the
// rounding of the steps.
//
// Derivative: near g the same rows S are active, and x is an affine function of g [dQP, arXiv
// 2410.06324]. The adjoint w solves one linear system,
//   [I N; N' 0] [w; .] = [dL/dx; 0]        hence        dL/dg = w = J2 J2' dL/dx.
// If a row is tight with multiplier 0 the derivative is not unique. The result is the mean of the
// derivatives with all such rows kept and with all dropped: for one such row, the central
// difference.
//
// Only the constructor allocates memory.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

#include "workstation/correction/distillation/active_set_factors.h"

namespace bess {

/// Rows a_i'x >= b_i, [rows x variables].
struct LinearConstraints {
  Eigen::SparseMatrix<double, Eigen::RowMajor> normals;
  Eigen::VectorXd bounds;
};

enum class QuadraticOutcome {
  kSolved,
  kContradiction,  ///< no point satisfies all rows: see clash()
  kStalled,        ///< no convergence because of rounding: badly scaled numbers
};

/// A row's part in a contradiction: with these positive weights the rows sum to 0 >= a positive
/// number.
struct ClashingRow {
  int row;
  double weight;
};

class QuadraticProgram {
 public:
  explicit QuadraticProgram(LinearConstraints constraints);

  /// Projects g [n]; finite numbers.
  QuadraticOutcome solve(const Eigen::VectorXd& g);

  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
  /// [rows], of the rows as given: 0 for inactive rows.
  [[nodiscard]] const Eigen::VectorXd& multipliers() const { return multipliers_; }
  /// Valid after kContradiction.
  [[nodiscard]] const std::vector<ClashingRow>& clash() const { return clash_; }
  /// Rows added and dropped in the last solve.
  [[nodiscard]] int steps() const { return steps_; }

  /// dL/dg from dL/dx at the last solve, which must be kSolved. Both [n], may not alias.
  void backward(const Eigen::VectorXd& gradient_x, Eigen::VectorXd& gradient_g);

 private:
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  using Columns = Eigen::SparseMatrix<double, Eigen::ColMajor>;
  struct Limit {
    double step;
    std::size_t position;  ///< active row whose multiplier reaches 0 there
  };

  void scale_rows();
  void start(const Eigen::VectorXd& g);
  void take_in_disjoint_rows();
  [[nodiscard]] bool claim_variables(int row);
  void mark(int row, bool active);
  void measure();
  void move(double step);
  void activate(int row, double multiplier);
  void image_of(int row, bool of_free = false);
  [[nodiscard]] double slack_of(int row) const;
  [[nodiscard]] int most_violated() const;
  [[nodiscard]] Limit limit_by_multipliers() const;
  void keep_signs();
  [[nodiscard]] bool take_in(int row);
  bool hold(int row);
  void let_go(std::size_t position);
  void keep_clash(int row);
  double recompute();
  void rebuild();
  void publish_multipliers();

  LinearConstraints rows_;     ///< scaled to |a| = 1
  Columns columns_;            ///< the same normals, by variable; empty if dense_ is used
  Eigen::MatrixXd dense_;      ///< the same normals, if many of their factors are not 0
  Eigen::VectorXd row_scale_;  ///< [rows] as solved = row_scale * as given
  ActiveSetFactors factors_;
  RowImage image_;                      ///< of the current row
  std::vector<int> active_;             ///< rows in the active set
  Eigen::VectorXd active_multipliers_;  ///< [n] of the active rows, in their order
  std::vector<char> is_active_;         ///< [rows]
  std::vector<int> neglected_;          ///< rows violated by no more than rounding, and dependent
  Eigen::VectorXd passed_over_;         ///< [rows] infinite for active and neglected rows, else 0
  std::vector<char> is_claimed_;        ///< [n] variables of the disjoint rows
  std::vector<int> candidates_;         ///< violated rows at the start
  std::vector<int> moved_;              ///< variables that a step moves
  std::vector<ClashingRow> clash_;
  Eigen::VectorXd free_minimum_;  ///< g [n]
  Eigen::VectorXd x_, z_, r_;     ///< [n], z and r as in active_set_factors.h
  Eigen::VectorXd multipliers_;   ///< [rows] of the rows as given
  Eigen::VectorXd slacks_;        ///< [rows] of the scaled rows at x
  Eigen::VectorXd sizes_;         ///< [rows] sum of their terms' sizes; empty if dense_ is
  double scale_ = 1;              ///< the largest of these sizes
  int steps_ = 0;
};

}  // namespace bess
