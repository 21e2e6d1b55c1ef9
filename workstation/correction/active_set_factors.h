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
// A row comes in by one Householder reflection of the columns of J2 that it meets, and goes out by Givens
// rotations. Rows of few terms meet few columns: an order between neighbours, whatever is active, meets
// two, because the reflection begins with a column it meets and so leaves all others as they are. Entries
// of d that are 0 are therefore passed over everywhere.
// All memory is taken in the constructor.
#pragma once

#include <Eigen/Core>

namespace bess {

class ActiveSetFactors {
 public:
  /// `inverse_root` is L^-1 [n x n].
  explicit ActiveSetFactors(const Eigen::MatrixXd& inverse_root);

  /// Empties the active set.
  void reset();
  [[nodiscard]] Eigen::Index size() const { return basis_.rows(); }
  [[nodiscard]] Eigen::Index active() const { return active_; }

  /// d += factor * row i of J: d = J'n term by term, for normals of few terms.
  void add_image(Eigen::Index i, double factor, Eigen::VectorXd& d) const {
    d += factor * basis_.row(i).transpose();
  }
  /// d = J'n at once, for others.
  void image(const Eigen::VectorXd& normal, Eigen::VectorXd& d) const {
    d.noalias() = basis_.transpose() * normal;
  }
  /// A row of J lies across its columns: reading one takes as long as reading eight columns.
  [[nodiscard]] bool prefers_whole_normals(Eigen::Index terms) const { return 8 * terms > size(); }
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

  /// z = direction(d), and the row of `d` becomes the last active one; independence(d) must be above 0.
  /// Leaves `d` changed.
  void add(Eigen::VectorXd& d, Eigen::VectorXd& z);
  /// Active row `position` goes; those behind it move up.
  void drop(Eigen::Index position);

 private:
  Eigen::MatrixXd start_;            ///< J of no active row, L^-T [n x n]
  Eigen::MatrixXd basis_;            ///< J [n x n]: columns 0..active-1 are J1
  Eigen::MatrixXd triangle_;         ///< R in its upper left corner [n x n]
  Eigen::VectorXd scratch_;          ///< [n]
  Eigen::VectorXd cosines_, sines_;  ///< rotations of one drop [n]
  Eigen::Index active_ = 0;
};

}  // namespace bess
