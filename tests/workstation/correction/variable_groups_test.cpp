#include "workstation/correction/variable_groups.h"

#include <algorithm>
#include <numeric>

#include "workstation/base/random.h"

namespace bess {
namespace {

using List = std::vector<int>;

List list_of(const VariableGroups& groups, const List& variables, bool of_columns,
             Eigen::Index from, Eigen::Index end) {
  List found;
  List list;
  groups.find(variables, found);
  if (of_columns) {
    groups.list_columns(found, from, end, list);
  } else {
    groups.list_variables(found, list);
  }
  return list;
}

TEST(VariableGroups, TheHessianTiesTheFirst) {
  Eigen::MatrixXd inverse_root = Eigen::MatrixXd::Identity(5, 5);
  inverse_root(3, 0) = 0.5;
  inverse_root(4, 3) = -1;
  const VariableGroups groups(inverse_root);
  EXPECT_EQ(list_of(groups, {0}, false, 0, 5), (List{0, 3, 4}));
  EXPECT_EQ(list_of(groups, {4, 0, 3}, true, 0, 5), (List{0, 3, 4}));
  EXPECT_EQ(list_of(groups, {2}, true, 0, 5), (List{2}));
  EXPECT_EQ(list_of(groups, {1, 4}, true, 1, 4), (List{1, 3}));
  EXPECT_EQ(list_of(groups, {}, true, 0, 5), List{});
}

/// Against lists of labels that are looked through one by one; sizes on both sides of a word.
TEST(VariableGroups, AgreeWithLabelsThroughChanges) {
  Random random(7);
  for (const int size : {1, 2, 63, 64, 65, 128, 200}) {
    VariableGroups groups(Eigen::MatrixXd::Identity(size, size));
    List of_variable(static_cast<std::size_t>(size));
    const auto pick = [&] {
      return static_cast<int>(random.index(static_cast<std::size_t>(size)));
    };
    for (int round = 0; round < 2; ++round) {
      std::iota(of_variable.begin(), of_variable.end(), 0);
      List of_column = of_variable;
      groups.reset();
      for (int change = 0; change < 3 * size; ++change) {
        const List variables{pick(), pick(), pick()};
        if (change % 3 == 0) {
          List tied;
          groups.find(variables, tied);
          groups.tie(tied);
          const int label = of_variable[static_cast<std::size_t>(variables[0])];
          for (const int variable : variables) {
            const int other = of_variable[static_cast<std::size_t>(variable)];
            std::ranges::replace(of_variable, other, label);
            std::ranges::replace(of_column, other, label);
          }
        } else if (change % 3 == 1) {
          groups.swap_columns(variables[0], variables[1]);
          std::swap(of_column[static_cast<std::size_t>(variables[0])],
                    of_column[static_cast<std::size_t>(variables[1])]);
        } else {
          const auto [from, to] = std::minmax({variables[0], variables[1]});
          groups.move_column_back(from, to);
          std::rotate(of_column.begin() + from, of_column.begin() + from + 1,
                      of_column.begin() + to + 1);
        }
        const List asked{pick(), pick()};
        const auto [from, to] = std::minmax({pick(), pick()});
        const auto members = [&](const List& labels, int first, int end) {
          List list;
          for (int k = first; k < end; ++k) {
            const bool is_in = std::ranges::any_of(asked, [&](int variable) {
              return of_variable[static_cast<std::size_t>(variable)] ==
                     labels[static_cast<std::size_t>(k)];
            });
            if (is_in) list.push_back(k);
          }
          return list;
        };
        ASSERT_EQ(list_of(groups, asked, false, 0, size), members(of_variable, 0, size));
        ASSERT_EQ(list_of(groups, asked, true, from, to), members(of_column, from, to));
      }
    }
  }
}

}  // namespace
}  // namespace bess
