#include "workstation/correction/distillation/quadratic_program.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/support/count_allocations.h"
#include "tests/support/random_programs.h"

namespace bess {
namespace {

using Vector = Eigen::VectorXd;

Vector vector_of(std::initializer_list<double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  std::ranges::copy(values, v.begin());
  return v;
}

/// Rows from dense lines.
LinearConstraints constraints_of(int variables, const std::vector<std::vector<double>>& lines,
                                 const std::vector<double>& bounds) {
  LinearConstraints constraints;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < static_cast<int>(lines.size()); ++i) {
    for (int j = 0; j < variables; ++j) entries.emplace_back(i, j, lines[i][j]);
  }
  constraints.normals.resize(static_cast<int>(lines.size()), variables);
  constraints.normals.setFromTriplets(entries.begin(), entries.end());
  constraints.bounds = Eigen::Map<const Vector>(bounds.data(), static_cast<int>(bounds.size()));
  return constraints;
}

struct HandProgram {
  const char* name;
  LinearConstraints constraints;
  Vector g, x, multipliers;
};

TEST(QuadraticProgram, HandCases) {
  const HandProgram cases[] = {
      {"a row of zeros that holds", constraints_of(2, {{0, 0}, {1, 0}}, {-1, 5}), vector_of({3, 4}),
       vector_of({5, 4}), vector_of({0, 2})},
      {"no rows", constraints_of(2, {}, {}), vector_of({3, 4}), vector_of({3, 4}), Vector(0)},
  };
  for (const HandProgram& c : cases) {
    SCOPED_TRACE(c.name);
    QuadraticProgram program(c.constraints);
    ASSERT_EQ(program.solve(c.g), QuadraticOutcome::kSolved);
    EXPECT_LT((program.x() - c.x).norm(), 1e-12) << program.x().transpose();
    EXPECT_LT((program.multipliers() - c.multipliers).norm(), 1e-12)
        << program.multipliers().transpose();
  }
}

/// Optimality conditions of a convex program, for a solution of any solver.
void expect_optimal(const TestProgram& program, const QuadraticProgram& solver, double tolerance) {
  const auto& [normals, bounds] = program.constraints;
  const Vector& x = solver.x();
  const Vector& u = solver.multipliers();
  const Vector slack = normals * x - bounds;
  for (int i = 0; i < slack.size(); ++i) {
    EXPECT_GE(slack[i], -tolerance) << "row " << i;
    EXPECT_GE(u[i], 0) << "row " << i;
    if (u[i] > 0) {
      EXPECT_NEAR(slack[i], 0, tolerance) << "row " << i;
    }
  }
  const Vector gradient = x - program.g - normals.transpose() * u;
  EXPECT_LT(gradient.cwiseAbs().maxCoeff(), tolerance * (1 + u.cwiseAbs().maxCoeff()));
}

ProgramKind kind_of(int round) { return static_cast<ProgramKind>(round % kProgramKinds); }

TEST(QuadraticProgram, SolutionsAreOptimal) {
  Random random(301);
  int let_go = 0;
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE(round);
    const int variables = round % 10 == 9 ? 60 + static_cast<int>(random.index(80))
                                          : 1 + static_cast<int>(random.index(40));
    const TestProgram program = random_program(kind_of(round / 3), variables, random);
    QuadraticProgram solver = program.solver();
    for (int again = 0; again < 2; ++again) {
      ASSERT_EQ(solver.solve(program.g), QuadraticOutcome::kSolved);
      expect_optimal(program, solver, 1e-9);
    }
    let_go += solver.steps() - static_cast<int>(std::ranges::count_if(
                                   solver.multipliers(), [](double u) { return u != 0; }));
  }
  EXPECT_GT(let_go, 100) << "rows are dropped on the way";
}

TEST(QuadraticProgram, UnitsDoNotMatter) {
  Random random(302);
  for (int round = 0; round < 50; ++round) {
    SCOPED_TRACE(round);
    TestProgram program = random_program(kind_of(round), 12, random);
    QuadraticProgram solver = program.solver();
    ASSERT_EQ(solver.solve(program.g), QuadraticOutcome::kSolved);
    const Vector x = solver.x();
    for (const double size : {1e-6, 1e6}) {
      TestProgram scaled = program;
      scaled.g *= size;
      scaled.constraints.bounds *= size;
      QuadraticProgram of_another_size = scaled.solver();
      ASSERT_EQ(of_another_size.solve(scaled.g), QuadraticOutcome::kSolved);
      EXPECT_LT((of_another_size.x() / size - x).norm(), 1e-9);
      scaled = program;
      scaled.constraints.normals *= size;
      scaled.constraints.bounds *= size;
      QuadraticProgram of_longer_rows = scaled.solver();
      ASSERT_EQ(of_longer_rows.solve(scaled.g), QuadraticOutcome::kSolved);
      EXPECT_LT((of_longer_rows.x() - x).norm(), 1e-9);
    }
  }
}

/// Weighted by the certificate the rows sum to 0 >= a positive number; and without any one of them
/// the others have a feasible point.
void expect_certificate(const TestProgram& program, const QuadraticProgram& solver) {
  const auto& [normals, bounds] = program.constraints;
  Vector sum = Vector::Zero(program.g.size());
  double bound = 0;
  for (const ClashingRow& part : solver.clash()) {
    EXPECT_GT(part.weight, 0) << "row " << part.row;
    sum += part.weight * Vector(normals.row(part.row));
    bound += part.weight * bounds[part.row];
  }
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_GT(bound, 1e-7);
  for (const ClashingRow& left_out : solver.clash()) {
    TestProgram rest = program;
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> kept;
    for (const ClashingRow& part : solver.clash()) {
      if (part.row == left_out.row) continue;
      const Vector normal = normals.row(part.row);
      for (int v = 0; v < normal.size(); ++v) {
        entries.emplace_back(static_cast<int>(kept.size()), v, normal[v]);
      }
      kept.push_back(bounds[part.row]);
    }
    rest.constraints.normals.resize(static_cast<int>(kept.size()), normals.cols());
    rest.constraints.normals.setFromTriplets(entries.begin(), entries.end());
    rest.constraints.bounds = Eigen::Map<const Vector>(kept.data(), static_cast<int>(kept.size()));
    QuadraticProgram of_the_rest = rest.solver();
    EXPECT_EQ(of_the_rest.solve(rest.g), QuadraticOutcome::kSolved) << "without " << left_out.row;
  }
}

TEST(QuadraticProgram, ContradictionsByHand) {
  struct Case {
    const char* name;
    LinearConstraints constraints;
    std::vector<int> clash;
  };
  const Case cases[] = {
      {"two bounds", constraints_of(1, {{1}, {-1}}, {2, -1}), {0, 1}},
      {"a bystander", constraints_of(2, {{0, 1}, {1, 0}, {-1, 0}}, {7, 2, -1}), {1, 2}},
      {"a row of zeros", constraints_of(2, {{1, 0}, {0, 0}}, {5, 1}), {1}},
      {"a ring", constraints_of(3, {{1, -1, 0}, {0, 1, -1}, {-1, 0, 1}}, {1, 1, 1}), {0, 1, 2}},
      {"three of four",
       constraints_of(2, {{1, 0}, {0, 1}, {-1, -1}, {1, 1}}, {1, 1, -1.5, -9}),
       {0, 1, 2}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    TestProgram program{c.constraints, Vector::Zero(c.constraints.normals.cols())};
    QuadraticProgram solver = program.solver();
    ASSERT_EQ(solver.solve(program.g), QuadraticOutcome::kContradiction);
    std::vector<int> rows;
    for (const ClashingRow& part : solver.clash()) rows.push_back(part.row);
    EXPECT_THAT(rows, testing::UnorderedElementsAreArray(c.clash));
    expect_certificate(program, solver);
  }
}

/// A positive sum of feasible rows, negated and with a bound beyond its range.
TEST(QuadraticProgram, ContradictionsAreNamed) {
  Random random(305);
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    const int variables = 2 + static_cast<int>(random.index(40));
    TestProgram program = random_program(kind_of(round), variables, random);
    const auto& [normals, bounds] = program.constraints;
    const auto old_rows = static_cast<int>(normals.rows());
    Vector sum = Vector::Zero(variables);
    double bound = 0;
    for (int part = 0; part < 3; ++part) {
      const auto row = static_cast<int>(random.index(static_cast<std::size_t>(old_rows)));
      const double weight = 0.5 + random.uniform();
      sum += weight * Vector(normals.row(row));
      bound += weight * bounds[row];
    }
    LinearConstraints more = program.constraints;
    more.normals.conservativeResize(old_rows + 1, variables);
    for (int v = 0; v < variables; ++v) more.normals.coeffRef(old_rows, v) = -sum[v];
    more.bounds.conservativeResize(old_rows + 1);
    more.bounds[old_rows] = -bound + 0.01;
    program.constraints = more;
    QuadraticProgram solver = program.solver();
    ASSERT_EQ(solver.solve(program.g), QuadraticOutcome::kContradiction);
    EXPECT_TRUE(std::ranges::any_of(solver.clash(),
                                    [&](const ClashingRow& part) { return part.row == old_rows; }));
    expect_certificate(program, solver);
  }
}

std::vector<int> active_rows(const QuadraticProgram& solver) {
  std::vector<int> rows;
  for (int i = 0; i < solver.multipliers().size(); ++i) {
    if (solver.multipliers()[i] != 0) rows.push_back(i);
  }
  return rows;
}

TEST(QuadraticProgram, BackwardIsTheDerivative) {
  constexpr double kStep = 1e-5;
  Random random(306);
  int compared = 0;
  for (int round = 0; round < 100; ++round) {
    SCOPED_TRACE(round);
    const int variables = 2 + static_cast<int>(random.index(40));
    const TestProgram program = random_program(kind_of(round), variables, random);
    const Vector gradient_x = normal_vector(variables, random);
    QuadraticProgram solver = program.solver();
    ASSERT_EQ(solver.solve(program.g), QuadraticOutcome::kSolved);
    const std::vector<int> active = active_rows(solver);
    Vector gradient(variables);
    solver.backward(gradient_x, gradient);
    for (int k = 0; k < std::min(variables, 10); ++k) {
      double loss[2];
      bool same_rows = true;
      for (const int side : {0, 1}) {
        Vector moved = program.g;
        moved[k] += side == 1 ? kStep : -kStep;
        ASSERT_EQ(solver.solve(moved), QuadraticOutcome::kSolved);
        same_rows &= active_rows(solver) == active;
        loss[side] = gradient_x.dot(solver.x());
      }
      if (!same_rows) continue;
      ++compared;
      EXPECT_NEAR(gradient[k], (loss[1] - loss[0]) / (2 * kStep), 1e-5) << "variable " << k;
    }
  }
  EXPECT_GT(compared, 500);
}

/// An active row without a multiplier: the mean of both sides, as in the central difference.
TEST(QuadraticProgram, BackwardAtAKink) {
  struct Case {
    const char* name;
    LinearConstraints constraints;
    Vector g;
    Vector gradient;  ///< of x1 + 3 x2
  };
  const Case cases[] = {
      {"one bound", constraints_of(2, {{1, 0}}, {3}), vector_of({3, 4}), vector_of({0.5, 3})},
      {"the bound twice", constraints_of(2, {{1, 0}, {2, 0}}, {3, 6}), vector_of({3, 4}),
       vector_of({0.5, 3})},
      {"an equal pair", constraints_of(2, {{1, -1}}, {0}), vector_of({4, 4}),
       vector_of({1.5, 2.5})},
      {"next to an active bound", constraints_of(2, {{1, 0}, {0, 1}}, {5, 4}), vector_of({3, 4}),
       vector_of({0, 1.5})},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    QuadraticProgram solver(c.constraints);
    ASSERT_EQ(solver.solve(c.g), QuadraticOutcome::kSolved);
    Vector gradient(2);
    for (int again = 0; again < 2; ++again) {
      solver.backward(vector_of({1, 3}), gradient);
      EXPECT_LT((gradient - c.gradient).norm(), 1e-12) << gradient.transpose();
    }
  }
}

TEST(QuadraticProgram, AllocatesNothingAfterTheConstructor) {
  Random random(307);
  for (int round = 0; round < 2 * kProgramKinds; ++round) {
    SCOPED_TRACE(round);
    const TestProgram program = random_program(kind_of(round), 48, random);
    QuadraticProgram solver = program.solver();
    const Vector gradient_x = normal_vector(48, random);
    Vector gradient(48);
    const long before = allocation_count();
    const QuadraticOutcome outcome = solver.solve(program.g);
    solver.backward(gradient_x, gradient);
    EXPECT_EQ(allocation_count(), before);
    EXPECT_EQ(outcome, QuadraticOutcome::kSolved);
  }
  const long before = allocation_count();
  const Vector one_more(100);
  EXPECT_GT(allocation_count(), before) << "the counter works";
}

}  // namespace
}  // namespace bess
