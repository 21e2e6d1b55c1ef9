// Variables that the Hessian or active rows tie together, and the columns of J that lie among them.
//
// Rows that share no variable, not even by way of other active rows, do not feel each other: sorted
// by group, J and R are block diagonal. Of an order between neighbours the groups are the blocks of
// equal values, and a row meets two of them, however many rows are active. A group has as many
// columns as variables. Groups grow together and are not parted before reset(): one too large costs
// time, not correctness. All memory is taken in the constructor.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace bess {

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

}  // namespace bess
