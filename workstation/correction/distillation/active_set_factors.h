// Factors of the active set of a projection onto linear constraints [Goldfarb and Idnani 1983, for
// the Hessian I]. With N the active constraints' normals as columns,
//
//   N = Q [R; 0]      J = Q = [J1 J2]      J1: as many columns as N, J2: the rest
//
// and for a normal n with d = J'n, split alike into d1 and d2,
//
//   z = J2 d2      the direction in x along which n'x grows fastest with the active rows
//                  unchanged, by |d2|^2 per unit
//   r = R^-1 d1    decrease of the active multipliers along it
//   J2 J2'         the projector onto the free directions of the active rows
//
// Adding a row takes one Householder reflection of the columns of J2 with d2 != 0, dropping one
// takes Givens rotations. d is 0 outside the groups of the row's variables (VariableGroups). In J2
// it often has fewer entries: an order between neighbours always has two, because the
// reflection begins with such a column and leaves all others unchanged. A RowImage lists the
// columns, and all work is on them. Only the constructors allocate memory.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace bess {

// Groups of variables that active rows couple, with their columns of J.
//
// Rows without a common variable, directly or through other active rows, are independent: sorted by
// group, J and R are block diagonal. For orders between neighbours the groups are the blocks of
// equal values, and a row touches two of them. A group has as many columns as variables. Groups
// only merge until reset(); too large a group costs time, not correctness. Only the constructor
// allocates memory.

class VariableGroups {
 public:
  explicit VariableGroups(Eigen::Index size);

  /// Each of the n variables is a group of its own again.
  void reset();

  /// The distinct groups of these variables; `groups` must have capacity n.
  void find(std::span<const int> variables, std::vector<int>& groups) const;
  /// The variables of these groups, or their columns in [from, end), ascending; `list` must have
  /// capacity n.
  void list_variables(std::span<const int> groups, std::vector<int>& list) const;
  void list_columns(std::span<const int> groups, Eigen::Index from, Eigen::Index end,
                    std::vector<int>& list) const;
  [[nodiscard]] int of_column(Eigen::Index column) const {
    return of_column_[static_cast<std::size_t>(column)];
  }

  /// Merges these groups (at least one).
  void tie(std::span<const int> groups);
  /// Swaps two columns.
  void swap_columns(Eigen::Index one, Eigen::Index other);

 private:
  using Words = std::vector<std::uint64_t>;  ///< one bit per member, words_ words per group

  void enumerate(std::span<const int> groups, const Words& members, std::size_t from,
                 std::size_t end, std::vector<int>& list) const;

  std::size_t words_;
  std::vector<int> of_variable_, of_column_;  ///< group of each, named by one of its variables
  Words variables_, columns_;
  int count_ = 0;  ///< number of groups
};

/// Image of a row's normal n under the factors; valid until they change.
struct RowImage {
  explicit RowImage(Eigen::Index size);

  Eigen::VectorXd d;        ///< J'n [n], 0 outside of the row's groups
  std::vector<int> groups;  ///< groups of the row's variables
  std::vector<int> held;    ///< their columns of J1, ascending
  std::vector<int> free;    ///< columns of J2 whose d is not 0, ascending
  double independence = 0;  ///< |d2|: distance of n from the span of N
};

class ActiveSetFactors {
 public:
  /// For n variables.
  explicit ActiveSetFactors(Eigen::Index size);

  /// Empties the active set.
  void reset();
  [[nodiscard]] Eigen::Index size() const { return basis_.rows(); }
  [[nodiscard]] Eigen::Index active() const { return active_; }

  /// Image of the normal with `factors` at `variables` and 0 elsewhere; its length is 1. With
  /// `of_free` only the J2 part is computed and `held` stays empty.
  void image_of(std::span<const int> variables, std::span<const double> factors, RowImage& image,
                bool of_free = false);

  /// Variables that the row can move, ascending; `list` must have capacity n.
  void list_variables(const RowImage& image, std::vector<int>& list) const {
    groups_.list_variables(image.groups, list);
  }
  /// z = J2 d2.
  void direction(const RowImage& image, Eigen::VectorXd& z) const;
  /// J2 J2' v into `free`; both [n], may not alias.
  void project_free(const Eigen::VectorXd& v, Eigen::VectorXd& free);
  /// head(active) of `r` = R^-1 d1; nonzero only in the held columns of the image.
  void solve(const RowImage& image, Eigen::VectorXd& r) const;
  /// head(active) of `y` becomes R^-1 y, or R^-T y.
  void solve(Eigen::VectorXd& y) const;
  void solve_transposed(Eigen::VectorXd& y) const;
  /// x += J1 y.
  void add_combination(const Eigen::VectorXd& y, Eigen::VectorXd& x) const;

  /// z = direction(image); the row becomes the last active one. Requires independence > 0. Changes
  /// the image.
  void add(RowImage& image, Eigen::VectorXd& z);
  /// Drops the active row at `position`. Of the returned places, ascending from `position`, each
  /// row moves to the place before its own: first those of the group, then those behind its last.
  /// Valid until the next call.
  std::span<const int> drop(Eigen::Index position);

 private:
  void finish(Eigen::Index from, RowImage& image) const;
  template <int Count>
  void turn_columns(std::size_t k);
  template <int Count>
  void turn_rows(Eigen::Index row);
  void close_gap(Eigen::Index gap);

  Eigen::MatrixXd basis_;     ///< J [n x n]: columns 0..active-1 are J1
  Eigen::MatrixXd triangle_;  ///< R in its upper left corner [n x n]
  VariableGroups groups_;
  Eigen::VectorXd scratch_;          ///< [n]
  Eigen::VectorXd cosines_, sines_;  ///< rotations of one drop [n]
  std::vector<int> places_;          ///< places of one drop
  Eigen::Index active_ = 0;
};

}  // namespace bess
