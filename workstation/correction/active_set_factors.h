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
// two, because the reflection begins with a column it meets and so leaves all others as they are. An image
// therefore lists the columns of J2 that its row meets, and all work is on these.
// All memory is taken in the constructors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace bess {

/// What the factors make of a row's normal n, until they change.
struct RowImage {
  explicit RowImage(Eigen::Index variables);

  Eigen::VectorXd d;        ///< J'n [n]
  std::vector<int> free;    ///< columns of J2 whose d is not 0, rising
  double independence = 0;  ///< |d2|: how far n lies from the span of the active ones, by G^-1
};

class ActiveSetFactors {
 public:
  /// `inverse_root` is L^-1 [n x n].
  explicit ActiveSetFactors(const Eigen::MatrixXd& inverse_root);

  /// Empties the active set.
  void reset();
  [[nodiscard]] Eigen::Index size() const { return basis_.rows(); }
  [[nodiscard]] Eigen::Index active() const { return active_; }

  /// The image of a normal [n], or of the one with `factors` at `variables` and 0 elsewhere. Its length is 1,
  /// by G^-1. d is filled from column `from` on: 0, or active() when what the active rows lack is enough.
  void image_of(const Eigen::VectorXd& normal, Eigen::Index from, RowImage& image) const;
  void image_of(std::span<const int> variables, std::span<const double> factors, double sign,
                Eigen::Index from, RowImage& image) const;
  /// A row of J lies across its columns: reading one takes as long as reading eight columns.
  [[nodiscard]] bool prefers_whole_normals(Eigen::Index terms) const { return 8 * terms > size(); }
  /// z = J2 d2.
  void direction(const RowImage& image, Eigen::VectorXd& z) const;
  /// J2 J2' v into `free`; both [n], may not alias.
  void project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free);
  /// head(active) of `r` = R^-1 d1.
  void solve(const Eigen::VectorXd& d, Eigen::VectorXd& r) const;
  /// head(active) of `y` becomes R^-T y.
  void solve_transposed(Eigen::VectorXd& y) const;
  /// x += J1 y.
  void add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const;

  /// z = direction(image), and its row becomes the last active one; its independence must be above 0.
  /// Leaves the image changed.
  void add(RowImage& image, Eigen::VectorXd& z);
  /// Active row `position` goes; those behind it move up.
  void drop(Eigen::Index position);

 private:
  void finish(Eigen::Index from, RowImage& image) const;
  template <int Count>
  void move_up(Eigen::Index position, Eigen::Index k);
  template <int Count>
  void rotate(Eigen::Index position, Eigen::Index row);

  Eigen::MatrixXd start_;            ///< J of no active row, L^-T [n x n]
  Eigen::MatrixXd basis_;            ///< J [n x n]: columns 0..active-1 are J1
  Eigen::MatrixXd triangle_;         ///< R in its upper left corner [n x n]
  Eigen::VectorXd scratch_;          ///< [n]
  Eigen::VectorXd cosines_, sines_;  ///< rotations of one drop [n]
  Eigen::Index active_ = 0;
};

}  // namespace bess
