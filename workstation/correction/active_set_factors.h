// Factors of the active set of a strictly convex quadratic program with Hessian G = L L', as Goldfarb and
// Idnani (1983) hold them. With N the active constraints' normals as columns,
//
//   L^-1 N = Q [R; 0]      J = L^-T Q = [J1 J2]      J1: as many columns as N, J2: the rest
//
// so that for a normal n and d = J'n, split alike into d1 and d2,
//
//   z = J2 d2        the direction in x along which n'x grows fastest and the active rows stay, |d2|^2 a unit
//   r = R^-1 d1      how the active multipliers fall along it
//   J2 J2'           the inverse of G on the directions that the active rows leave free
//
// A row comes in by one Householder reflection of J2 (the column z is known already, so it is one rank-one
// update, where Givens rotations would go over J2 column by column), and goes out by Givens rotations.
// All memory is taken in the constructor.
#pragma once

#include <Eigen/Core>

namespace bess {

class ActiveSetFactors {
 public:
  /// `inverse_root_transposed` is L^-1: the transpose of J for an empty active set, [n x n].
  explicit ActiveSetFactors(const Eigen::MatrixXd& inverse_root_transposed);

  /// Empties the active set.
  void reset();
  [[nodiscard]] Eigen::Index size() const { return transposed_.rows(); }
  [[nodiscard]] Eigen::Index active() const { return active_; }

  /// Row i of J as a column [n]: d = sum of n_i * column_of(i).
  [[nodiscard]] auto column_of(Eigen::Index i) const { return transposed_.col(i); }
  /// z = J2 d2.
  void direction(const Eigen::VectorXd& d, Eigen::VectorXd& z) const;
  /// J2 J2' v into `free`; both [n], may not alias.
  void project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free);
  /// |d2|: how far the row of d lies from the span of the active ones, in the metric of G^-1.
  [[nodiscard]] double independence(const Eigen::VectorXd& d) const;
  /// head(active) of `r` = R^-1 d1.
  void solve(const Eigen::VectorXd& d, Eigen::VectorXd& r) const;
  /// head(active) of `y` becomes R^-T y.
  void solve_transposed(Eigen::VectorXd& y) const;
  /// x += J1 y.
  void add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const;

  /// The row of `d` becomes the last active one; z = direction(d), and independence(d) is above 0.
  void add(const Eigen::VectorXd& d, const Eigen::VectorXd& z);
  /// Active row `position` goes; those behind it move up.
  void drop(Eigen::Index position);

 private:
  Eigen::MatrixXd start_;       ///< L^-1 [n x n]
  Eigen::MatrixXd transposed_;  ///< J' [n x n]: rows 0..active-1 are J1'
  Eigen::MatrixXd triangle_;    ///< R in its upper left corner [n x n]
  Eigen::VectorXd reflector_;   ///< [n]
  Eigen::VectorXd along_;       ///< [n]
  Eigen::MatrixXd rotations_;   ///< [2 x n] cosines and sines of a drop
  Eigen::Index active_ = 0;
};

}  // namespace bess
