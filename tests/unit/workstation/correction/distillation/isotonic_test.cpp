#include "workstation/correction/distillation/correction_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "workstation/base/random.h"

namespace bess {
namespace {

using Values = std::vector<double>;

Values project(int rows, int columns, const Values& y, const RowBounds& bounds = {}) {
  Values x(y.size());
  IsotonicProjection(rows, columns).project(y, bounds, x);
  return x;
}

/// Exact, without tolerance.
bool feasible(int rows, int columns, const Values& x, const RowBounds& bounds) {
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const double value = x[i * columns + j];
      if (!std::isfinite(value)) return false;
      if (i + 1 < rows && value < x[(i + 1) * columns + j]) return false;
      if (j + 1 < columns && value < x[i * columns + j + 1]) return false;
      if (i < bounds.lower_rows && value < bounds.lower) return false;
      if (i >= rows - bounds.upper_rows && value > bounds.upper) return false;
    }
  }
  return true;
}

/// None, lower only, upper only, both; up to half of the rows at each end.
RowBounds random_bounds(int rows, int kind, Random& random) {
  RowBounds bounds;
  const auto some_rows = [&] { return 1 + static_cast<int>(random.index((rows + 1) / 2)); };
  if ((kind & 1) != 0) bounds.lower_rows = some_rows();
  if ((kind & 2) != 0) bounds.upper_rows = std::min(some_rows(), rows - bounds.lower_rows);
  bounds.lower = random.normal() * 0.7 + 0.5;
  bounds.upper = bounds.lower - 0.05 - random.uniform();
  return bounds;
}

/// Constant input of any size is one level set: rounding of long sums must not split it.
TEST(Isotonic, ConstantInputOfAnySize) {
  for (const int side : {16, 64, 256, 700}) {
    SCOPED_TRACE(side);
    const Values y(static_cast<std::size_t>(side * side), 0.1);
    const Values x = project(side, side, y);
    EXPECT_NEAR(*std::ranges::min_element(x), 0.1, 1e-9);
    EXPECT_NEAR(*std::ranges::max_element(x), 0.1, 1e-9);
  }
}

/// A random cut t_i that does not increase with the row: the cells left of it are an upper set.
std::vector<int> random_staircase(int rows, int columns, Random& random) {
  std::vector<int> cut(static_cast<std::size_t>(rows));
  for (int& t : cut) t = static_cast<int>(random.index(columns + 1));
  std::ranges::sort(cut, std::greater{});
  return cut;
}

/// Variational inequality: x is the projection if and only if (x - y).d >= 0 for every feasible
/// direction d. Raising an upper part of a set of equal cells, and lowering a lower part, generate
/// all of them.
TEST(Isotonic, EveryLatticeIsOptimal) {
  Random random(103);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(round);
    const int rows = 1 + static_cast<int>(random.index(32));
    const int columns = 1 + static_cast<int>(random.index(16));
    const RowBounds bounds = random_bounds(rows, round % 4, random);
    Values y(static_cast<std::size_t>(rows * columns));
    for (double& value : y) value = random.normal();
    for (int c = 0; c < rows * columns; ++c) {  // a trend, then some ties
      y[c] -= round % 3 * 0.1 * (c / columns);
      if (round % 5 == 4) y[c] = std::round(2 * y[c]) / 2;
    }
    const Values x = project(rows, columns, y, bounds);
    ASSERT_TRUE(feasible(rows, columns, x, bounds));
    const std::set<double> levels(x.begin(), x.end());
    for (int direction = 0; direction < 60; ++direction) {
      const std::vector<int> cut = random_staircase(rows, columns, random);
      for (const double level : levels) {
        double raise = 0;
        double lower = 0;
        bool may_raise = true;
        bool may_lower = true;
        for (int i = 0; i < rows; ++i) {
          for (int j = 0; j < columns; ++j) {
            const int c = i * columns + j;
            if (x[c] != level) continue;
            if (j < cut[i]) {
              raise += x[c] - y[c];
              may_raise &= i < rows - bounds.upper_rows || level < bounds.upper;
            } else {
              lower -= x[c] - y[c];
              may_lower &= i >= bounds.lower_rows || level > bounds.lower;
            }
          }
        }
        if (may_raise) {
          ASSERT_GE(raise, -1e-9) << "level " << level;
        }
        if (may_lower) {
          ASSERT_GE(lower, -1e-9) << "level " << level;
        }
      }
    }
  }
}

}  // namespace
}  // namespace bess
