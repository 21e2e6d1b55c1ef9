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
// (VariableGroups), and of J2 often fewer: an order between neighbours, whatever is active,
// meets two, because the reflection begins with a column it meets and so leaves all others as they
// are. An image lists these columns, and all work is on them. All memory is taken in the
// constructors.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace bess {

// Variables that the Hessian or active rows tie together, and the columns of J that lie among them.
//
// Rows that share no variable, not even by way of other active rows, do not feel each other: sorted
// by group, J and R are block diagonal. Of an order between neighbours the groups are the blocks of
// equal values, and a row meets two of them, however many rows are active. A group has as many
// columns as variables. Groups grow together and are not parted before reset(): one too large costs
// time, not correctness. All memory is taken in the constructor.

class VariableGroups {
 public:
  /// `inverse_root` is L^-1 [n x n]: variables are tied where it is not 0.
  explicit VariableGroups(const Eigen::MatrixXd& inverse_root);

  /// As they were constructed.
  void reset();

  /// The groups of these variables, each once; `groups` must hold n of them without growing.
  void find(std::span<const int> variables, std::vector<int>& groups) const;
  /// The variables of these groups, or their columns from `from` to before `end`; rising. `list`
  /// must hold n without growing.
  void list_variables(std::span<const int> groups, std::vector<int>& list) const;
  void list_columns(std::span<const int> groups, Eigen::Index from, Eigen::Index end,
                    std::vector<int>& list) const;
  [[nodiscard]] int of_column(Eigen::Index column) const {
    return of_column_[static_cast<std::size_t>(column)];
  }

  /// Makes one group of these, which are one or more.
  void tie(std::span<const int> groups);
  /// Two columns change places.
  void swap_columns(Eigen::Index one, Eigen::Index other);
  /// Column `from` goes behind those up to `to`, which move up.
  void move_column_back(Eigen::Index from, Eigen::Index to);

 private:
  using Words = std::vector<std::uint64_t>;  ///< a bit for each member, words_ words a group

  void enumerate(std::span<const int> groups, const Words& members, std::size_t from,
                 std::size_t end, std::vector<int>& list) const;

  std::size_t words_;
  std::vector<int> of_variable_, of_column_;  ///< group of each, named by one of its variables
  Words variables_, columns_;
  int count_;  ///< of groups
  std::vector<int> start_of_;
  Words start_;
  int start_count_;
};

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
