#include "workstation/correction/active_set_factors.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "workstation/base/random.h"

namespace bess {
namespace {

/// Rows of a few terms among neighbours, so that groups form, meet and stay apart; added and
/// dropped at random.
class FactorsTest : public ::testing::TestWithParam<int> {
 protected:
  struct Row {
    std::vector<int> variables;
    std::vector<double> factors;
    Eigen::VectorXd normal;
  };

  FactorsTest() : inverse_root(Eigen::MatrixXd::Identity(GetParam(), GetParam())) {}

  [[nodiscard]] Row random_row(int reach) {
    const int size = GetParam();
    Row row{.variables = {}, .factors = {}, .normal = Eigen::VectorXd::Zero(size)};
    const int first = static_cast<int>(random.index(static_cast<std::size_t>(size)));
    for (int v = first; v < std::min(size, first + reach); ++v) {
      row.normal[v] = v == first ? 1 : random.normal();
    }
    row.normal /= (inverse_root * row.normal).norm();
    for (int v = first; v < std::min(size, first + reach); ++v) {
      row.variables.push_back(v);
      row.factors.push_back(row.normal[v]);
    }
    return row;
  }

  /// Everything that the header promises of J and R, through what anyone can ask for.
  void check(ActiveSetFactors& factors, const std::vector<Row>& active) {
    const Eigen::Index size = GetParam();
    const auto count = static_cast<Eigen::Index>(active.size());
    ASSERT_EQ(factors.active(), count);
    const Eigen::MatrixXd inverse = inverse_root.transpose() * inverse_root;
    Eigen::MatrixXd normals(size, count);
    for (Eigen::Index k = 0; k < count; ++k)
      normals.col(k) = active[static_cast<std::size_t>(k)].normal;
    const Eigen::LDLT<Eigen::MatrixXd> gram(normals.transpose() * inverse * normals);
    // J2 J2' = G^-1 - G^-1 N (N' G^-1 N)^-1 N' G^-1
    const Eigen::MatrixXd to_multipliers = gram.solve(normals.transpose() * inverse);
    const Eigen::MatrixXd free_inverse = inverse - inverse * normals * to_multipliers;
    Eigen::VectorXd v(size), free(size), z(size), r(size);
    for (double& value : v) value = random.normal();
    factors.project_free(v, free);
    ASSERT_LT((free - free_inverse * v).norm(), 1e-9);
    // R^-1 R^-T y = (N' G^-1 N)^-1 y    J1 R^-T y = G^-1 N (N' G^-1 N)^-1 y
    Eigen::VectorXd y(size);
    for (double& value : y) value = random.normal();
    const Eigen::VectorXd by_gram = gram.solve(y.head(count));
    Eigen::VectorXd x = Eigen::VectorXd::Zero(size);
    factors.solve_transposed(y);
    factors.add_combination(y, x);
    factors.solve(y);
    ASSERT_LT((y.head(count) - by_gram).norm(), 1e-8 * (1 + by_gram.norm()));
    ASSERT_LT((x - inverse * normals * by_gram).norm(), 1e-8 * (1 + by_gram.norm()));
    const Row row = random_row(2);
    RowImage image(size);
    factors.image_of(row.variables, row.factors, -1, image);
    ASSERT_NEAR(image.independence * image.independence, row.normal.dot(free_inverse * row.normal),
                1e-9);
    factors.direction(image, z);
    ASSERT_LT((z + free_inverse * row.normal).norm(), 1e-9);
    factors.solve(image, r);
    ASSERT_LT((r.head(count) + to_multipliers * row.normal).norm(), 1e-7);
    std::vector<int> moved;
    factors.list_variables(image, moved);
    for (int i = 0; i < size; ++i) {
      ASSERT_TRUE(z[i] == 0 || std::ranges::binary_search(moved, i)) << i;
    }
    RowImage of_free(size);
    factors.image_of(row.variables, row.factors, -1, of_free, true);
    ASSERT_NEAR(of_free.independence, image.independence, 1e-12);
  }

  void add_and_drop() {
    ActiveSetFactors factors(inverse_root);
    const int size = GetParam();
    std::vector<Row> active;
    RowImage image(size);
    Eigen::VectorXd z(size);
    int drops = 0;
    for (int step = 0; step < 4 * size; ++step) {
      const Row row = random_row(step % 7 == 0 ? size : 1 + step % 3);
      factors.image_of(row.variables, row.factors, 1, image);
      if (image.independence > 0.03 && step % 3 != 2) {
        factors.add(image, z);
        active.push_back(row);
      } else if (!active.empty()) {
        const auto position = random.index(active.size());
        const auto places = factors.drop(static_cast<Eigen::Index>(position));
        ASSERT_EQ(places.front(), position);
        for (std::size_t k = 1; k < places.size(); ++k) {
          ASSERT_LT(places[k - 1], places[k]);
          active[static_cast<std::size_t>(places[k - 1])] =
              active[static_cast<std::size_t>(places[k])];
        }
        ASSERT_EQ(places.back() + 1, active.size());
        active.pop_back();
        ++drops;
      }
      check(factors, active);
      if (HasFatalFailure()) return;
    }
    EXPECT_GT(drops, size / 2);
    factors.reset();
    active.clear();
    check(factors, active);
  }

  Random random{5};
  Eigen::MatrixXd inverse_root;  ///< L^-1
};

TEST_P(FactorsTest, OfAProjection) { add_and_drop(); }

/// Two blocks of variables and one alone: groups from the start.
TEST_P(FactorsTest, OfAHessianInBlocks) {
  const int half = GetParam() / 2;
  for (int column = 0; column + 1 < GetParam(); ++column) {
    const int end = column < half ? half : GetParam() - 1;
    for (int row = column; row < end; ++row) {
      inverse_root(row, column) = (row == column ? 2 : 0.3) + 0.1 * random.normal();
    }
  }
  add_and_drop();
}

INSTANTIATE_TEST_SUITE_P(Sizes, FactorsTest, ::testing::Values(2, 7, 24, 45));

/// What the solver's speed on orders rests on: a row looks at its own groups, however many rows are
/// active.
TEST(ActiveSetFactors, ARowMeetsItsOwnGroupsAlone) {
  ActiveSetFactors factors(Eigen::MatrixXd::Identity(12, 12));
  RowImage image(12);
  Eigen::VectorXd z(12);
  const double factor[] = {std::sqrt(0.5), -std::sqrt(0.5)};
  for (const int first : {0, 6, 1, 7, 8, 2, 9}) {  // blocks 0..3 and 6..10
    const int variables[] = {first, first + 1};
    factors.image_of(variables, factor, 1, image);
    EXPECT_EQ(image.free.size(), 2U) << first;
    factors.add(image, z);
  }
  const int in_one[] = {0, 3};
  factors.image_of(in_one, factor, 1, image);
  EXPECT_EQ(image.held.size(), 3U);
  EXPECT_LT(image.independence, 1e-12);
  const int between[] = {3, 6};
  factors.image_of(between, factor, 1, image);
  EXPECT_EQ(image.held.size(), 7U);
  EXPECT_EQ(image.free.size(), 2U);
  const int outside[] = {5, 11};
  factors.image_of(outside, factor, 1, image);
  EXPECT_TRUE(image.held.empty());
}

}  // namespace
}  // namespace bess
