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
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace bess {

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
  Eigen::VectorXd x_, z_, r_;     ///< [n], z and r of the factors
  Eigen::VectorXd multipliers_;   ///< [rows] of the rows as given
  Eigen::VectorXd slacks_;        ///< [rows] of the scaled rows at x
  Eigen::VectorXd sizes_;         ///< [rows] sum of their terms' sizes; empty if dense_ is
  double scale_ = 1;              ///< the largest of these sizes
  int steps_ = 0;
};

}  // namespace bess
