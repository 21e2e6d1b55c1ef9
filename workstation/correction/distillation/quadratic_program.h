// A strictly convex quadratic program, dense in the variables and sparse in the rows, and its
// derivative:
//
//   x = argmin 1/2 x'Gx - g'x   s.t.  a_i'x = b_i  for the first rows, a_i'x >= b_i for the others
//
// Dual active-set method [Goldfarb, Idnani 1983, Mathematical Programming 27]: starts at the free
// minimum G^-1 g, and takes in the row violated most, letting go of active rows whose multipliers
// would turn negative, until none is violated. Each step raises the dual value, so it ends.
// Degenerate, dependent and repeated rows need no care: a row that depends on the active ones takes
// a step in the multipliers alone. When it can take none, no x satisfies all rows, and the
// multipliers say which of them clash (Farkas). At the end x and multipliers are computed anew from
// the factors, so that steps leave no rounding behind.
//
// Derivative: near g the same rows S stay active, where x is an affine function of g [dQP, arXiv
// 2410.06324]. The adjoint w solves one linear system on them,
//   [G N; N' 0] [w; .] = [dL/dx; 0]        hence        dL/dg = w = J2 J2' dL/dx.
// Where a row is tight with multiplier 0 the derivative has several sides. It is then the mean of
// the one with all such rows held and the one with all let go: for one such row, what a central
// difference sees.
//
// After the constructor nothing allocates.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <vector>

#include "workstation/correction/distillation/active_set_factors.h"

namespace bess {

/// Rows a_i'x >= b_i, [rows x variables]; the first `equalities` of them hold as a_i'x = b_i.
struct LinearConstraints {
  Eigen::SparseMatrix<double, Eigen::RowMajor> normals;
  Eigen::VectorXd bounds;
  int equalities = 0;
};

enum class QuadraticOutcome {
  kSolved,
  kContradiction,  ///< no point satisfies all rows: see clash()
  kStalled,        ///< rounding keeps it from ending: numbers of very different size
};

/// A row's part in a contradiction: weights times rows sum to 0 >= a positive number. Weights of
/// inequalities are positive.
struct ClashingRow {
  int row;
  double weight;
};

class QuadraticProgram {
 public:
  /// Projection onto the rows: G is the identity.
  explicit QuadraticProgram(LinearConstraints constraints);
  /// G [n x n] symmetric and positive definite; throws std::invalid_argument otherwise.
  QuadraticProgram(const Eigen::MatrixXd& hessian, LinearConstraints constraints);

  /// Solves for the linear term g [n]; finite numbers.
  QuadraticOutcome solve(const Eigen::VectorXd& g);

  [[nodiscard]] const Eigen::VectorXd& x() const { return x_; }
  /// [rows], of the rows as given: 0 for rows that are not active, >= 0 for inequalities.
  [[nodiscard]] const Eigen::VectorXd& multipliers() const { return multipliers_; }
  /// After kContradiction.
  [[nodiscard]] const std::vector<ClashingRow>& clash() const { return clash_; }
  /// Rows taken in and let go in the last solve.
  [[nodiscard]] int steps() const { return steps_; }

  /// dL/dg from dL/dx at the last solve, which was kSolved. Both [n], may not alias.
  void backward(const Eigen::VectorXd& gradient_x, Eigen::VectorXd& gradient_g);

 private:
  /// A row in the active set; its sign is -1 where an equality was met from above.
  struct ActiveRow {
    int row;
    double sign;
  };
  using Rows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  using Columns = Eigen::SparseMatrix<double, Eigen::ColMajor>;
  struct Limit {
    double step;
    std::size_t position;  ///< of the active row whose multiplier reaches 0 there
  };

  QuadraticProgram(LinearConstraints&& constraints, const Eigen::MatrixXd& inverse_root);
  void scale_rows(const Eigen::MatrixXd& inverse_root);
  void start(const Eigen::VectorXd& g);
  void take_in_disjoint_rows();
  [[nodiscard]] bool claim_variables(int row);
  void mark(int row, bool active);
  void measure();
  [[nodiscard]] Eigen::Index active_equalities() const;
  void move(double step);
  void activate(int row, double sign, double multiplier);
  void image_of(int row, double sign, bool of_free = false);
  [[nodiscard]] double slack_of(int row) const;
  [[nodiscard]] int most_violated() const;
  [[nodiscard]] Limit limit_by_multipliers() const;
  void keep_signs();
  [[nodiscard]] bool take_in(int row, double sign);
  bool hold(int row, double sign);
  void let_go(std::size_t position);
  void keep_clash(int row, double sign);
  double recompute();
  void rebuild();
  void publish_multipliers();

  LinearConstraints rows_;     ///< scaled to |L^-1 a| = 1
  Columns columns_;            ///< the same normals, by variable; empty when dense_ is not
  Eigen::MatrixXd dense_;      ///< the same normals, where many of their factors are not 0
  bool is_projection_;         ///< G is the identity
  Eigen::VectorXd row_scale_;  ///< [rows] as solved = row_scale * as given
  ActiveSetFactors factors_;
  RowImage image_;                      ///< of the row that is looked at
  std::vector<ActiveRow> active_;       ///< equalities first
  Eigen::VectorXd active_multipliers_;  ///< [n] of the active rows, in their order
  std::vector<char> is_active_;         ///< [rows]
  std::vector<int> neglected_;          ///< rows violated by no more than rounding, and dependent
  Eigen::VectorXd passed_over_;         ///< [rows] infinite for active and neglected rows, else 0
  std::vector<char> is_claimed_;        ///< [n] variables of the disjoint rows
  std::vector<int> candidates_;         ///< violated rows at the start
  std::vector<int> moved_;              ///< variables that a step moves
  std::vector<ClashingRow> clash_;
  Eigen::VectorXd free_minimum_;  ///< G^-1 g [n]
  Eigen::VectorXd x_, z_, r_;     ///< [n], z and r as in active_set_factors.h
  Eigen::VectorXd multipliers_;   ///< [rows] of the rows as given
  Eigen::VectorXd slacks_;        ///< [rows] of the scaled rows at x
  Eigen::VectorXd sizes_;         ///< [rows] and of their terms, together; empty when dense_ is
  double scale_ = 1;              ///< the largest of these sizes
  int steps_ = 0;
};

}  // namespace bess
