// Factors of the active set of a strictly convex quadratic program with Hessian G = L L', as
// Goldfarb and Idnani (1983) hold them. With N the active constraints' normals as columns,
//
//   L^-1 N = Q [R; 0]      J = L^-T Q = [J1 J2]      J1: as many columns as N, J2: the rest
//
// so that for a normal n and d = J'n, split alike into d1 and d2,
//
//   z = J2 d2      the direction in x along which n'x grows fastest and the active rows stay,
//                  |d2|^2 a unit
//   r = R^-1 d1    how the active multipliers fall along it
//   J2 J2'         the inverse of G on the directions that the active rows leave free
//
// A row comes in by one Householder reflection of the columns of J2 that it meets, and goes out by
// Givens rotations. It meets columns of the groups that its variables belong to
// (variable_groups.h), and of J2 often fewer: an order between neighbours, whatever is active,
// meets two, because the reflection begins with a column it meets and so leaves all others as they
// are. An image lists these columns, and all work is on them. All memory is taken in the
// constructors.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "workstation/correction/variable_groups.h"

namespace bess {

/// What the factors make of a row's normal n, until they change.
struct RowImage {
  explicit RowImage(Eigen::Index size);

  Eigen::VectorXd d;        ///< J'n [n], 0 outside of the row's groups
  std::vector<int> groups;  ///< those of the row's variables
  std::vector<int> held;    ///< their columns of J1, rising
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

  /// The image of the normal with `factors` at `variables` and 0 elsewhere. Its length is 1, by
  /// G^-1. Nothing of J1 is looked at, and no `held` listed, when `of_free` alone is asked for:
  /// what the active rows lack.
  void image_of(std::span<const int> variables, std::span<const double> factors, double sign,
                RowImage& image, bool of_free = false);
  /// The variables that the row can move, rising; `list` must hold n without growing.
  void list_variables(const RowImage& image, std::vector<int>& list) const {
    groups_.list_variables(image.groups, list);
  }
  /// z = J2 d2.
  void direction(const RowImage& image, Eigen::VectorXd& z) const;
  /// J2 J2' v into `free`; both [n], may not alias.
  void project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free);
  /// head(active) of `r` = R^-1 d1: 0 but for the held columns of the image.
  void solve(const RowImage& image, Eigen::VectorXd& r) const;
  /// head(active) of `y` becomes R^-1 y, or R^-T y.
  void solve(Eigen::VectorXd& y) const;
  void solve_transposed(Eigen::VectorXd& y) const;
  /// x += J1 y.
  void add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const;

  /// z = direction(image), and its row becomes the last active one; its independence must be above
  /// 0. Leaves the image changed.
  void add(RowImage& image, Eigen::VectorXd& z);
  /// Active row `position` goes. Of the places returned, rising from `position` on, each row moves
  /// into the place before its own: first the group's, then those behind the last of these. Valid
  /// until the next call.
  std::span<const int> drop(Eigen::Index position);

 private:
  void finish(Eigen::Index from, RowImage& image) const;
  template <int Count>
  void turn_columns(std::size_t k);
  template <int Count>
  void turn_rows(Eigen::Index row);
  void close_gap(Eigen::Index gap);

  Eigen::MatrixXd start_;     ///< J of no active row, L^-T [n x n]
  Eigen::MatrixXd basis_;     ///< J [n x n]: columns 0..active-1 are J1
  Eigen::MatrixXd triangle_;  ///< R in its upper left corner [n x n]
  VariableGroups groups_;
  Eigen::VectorXd scratch_;          ///< [n]
  Eigen::VectorXd cosines_, sines_;  ///< rotations of one drop [n]
  std::vector<int> places_;          ///< of one drop
  Eigen::Index active_ = 0;
};

}  // namespace bess
