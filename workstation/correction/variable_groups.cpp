#include "workstation/correction/variable_groups.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace bess {
namespace {

constexpr std::size_t kBits = 64;  ///< of a word

}  // namespace

VariableGroups::VariableGroups(const Eigen::MatrixXd& inverse_root)
    : words_((static_cast<std::size_t>(inverse_root.rows()) + kBits - 1) / kBits),
      of_variable_(static_cast<std::size_t>(inverse_root.rows())),
      of_column_(of_variable_.size()),
      variables_(of_variable_.size() * words_),
      count_(static_cast<int>(of_variable_.size())) {
  std::iota(of_variable_.begin(), of_variable_.end(), 0);
  std::iota(of_column_.begin(), of_column_.end(), 0);
  for (std::size_t v = 0; v < of_variable_.size(); ++v) {
    variables_[v * words_ + v / kBits] |= std::uint64_t{1} << v % kBits;
  }
  columns_ = variables_;
  for (Eigen::Index column = 0; column < inverse_root.cols(); ++column) {
    for (Eigen::Index row = 0; row < inverse_root.rows(); ++row) {
      if (inverse_root(row, column) == 0) continue;
      const int groups[] = {of_column(row), of_column(column)};
      if (groups[0] != groups[1]) tie(groups);
    }
  }
  start_of_ = of_variable_;
  start_ = variables_;
  start_count_ = count_;
}

void VariableGroups::reset() {
  of_variable_ = start_of_;
  of_column_ = start_of_;
  variables_ = start_;
  columns_ = start_;
  count_ = start_count_;
}

void VariableGroups::find(std::span<const int> variables, std::vector<int>& groups) const {
  groups.clear();
  if (count_ == 1) variables = variables.first(std::min<std::size_t>(variables.size(), 1));
  for (const int variable : variables) {
    const int group = of_variable_[static_cast<std::size_t>(variable)];
    if (std::ranges::find(groups, group) == groups.end()) groups.push_back(group);
  }
}

void VariableGroups::list_variables(std::span<const int> groups, std::vector<int>& list) const {
  enumerate(groups, variables_, 0, of_variable_.size(), list);
}

void VariableGroups::list_columns(std::span<const int> groups, Eigen::Index from, Eigen::Index end,
                                  std::vector<int>& list) const {
  enumerate(groups, columns_, static_cast<std::size_t>(from), static_cast<std::size_t>(end), list);
}

void VariableGroups::enumerate(std::span<const int> groups, const Words& members, std::size_t from,
                               std::size_t end, std::vector<int>& list) const {
  list.resize(end - from);
  if (count_ == 1 && !groups.empty()) {  // all
    std::iota(list.begin(), list.end(), static_cast<int>(from));
    return;
  }
  std::size_t count = 0;
  for (std::size_t at = from; at < end; at += kBits - at % kBits) {
    std::uint64_t left = 0;
    for (const int group : groups) {
      left |= members[static_cast<std::size_t>(group) * words_ + at / kBits];
    }
    left &= ~std::uint64_t{0} << at % kBits;
    const std::size_t first = at - at % kBits;
    if (end - first < kBits) left &= ~(~std::uint64_t{0} << (end - first));
    for (; left != 0; left &= left - 1) {
      list[count++] = static_cast<int>(first) + std::countr_zero(left);
    }
  }
  list.resize(count);
}

void VariableGroups::tie(std::span<const int> groups) {
  const int one = groups.front();
  count_ -= static_cast<int>(groups.size()) - 1;
  for (const int other : groups.subspan(1)) {
    std::ranges::replace(of_variable_, other, one);
    std::ranges::replace(of_column_, other, one);
    for (std::size_t word = 0; word < words_; ++word) {
      const auto to = static_cast<std::size_t>(one) * words_ + word;
      const auto from = static_cast<std::size_t>(other) * words_ + word;
      variables_[to] |= std::exchange(variables_[from], 0);
      columns_[to] |= std::exchange(columns_[from], 0);
    }
  }
}

void VariableGroups::swap_columns(Eigen::Index one, Eigen::Index other) {
  if (of_column(one) == of_column(other)) return;
  for (const Eigen::Index column : {one, other}) {
    const auto bit = std::uint64_t{1} << static_cast<std::size_t>(column) % kBits;
    for (const int group : {of_column(one), of_column(other)}) {
      columns_[static_cast<std::size_t>(group) * words_ +
               static_cast<std::size_t>(column) / kBits] ^= bit;
    }
  }
  std::swap(of_column_[static_cast<std::size_t>(one)], of_column_[static_cast<std::size_t>(other)]);
}

void VariableGroups::move_column_back(Eigen::Index from, Eigen::Index to) {
  for (Eigen::Index column = from; column < to; ++column) swap_columns(column, column + 1);
}

}  // namespace bess
