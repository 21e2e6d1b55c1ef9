// Feasible quadratic programs from seeds, of the kinds that a solver must handle.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "workstation/base/random.h"
#include "workstation/correction/distillation/quadratic_program.h"

namespace bess {

/// min 1/2 |x - g|^2 under `constraints`.
struct TestProgram {
  LinearConstraints constraints;
  Eigen::VectorXd g;

  [[nodiscard]] QuadraticProgram solver() const { return QuadraticProgram(constraints); }
};

enum class ProgramKind {
  kSparseRows,  ///< rows of two to four terms
  kDenseRows,   ///< rows of all variables
  kOrder,       ///< a lattice that must not increase along rows and columns
  kDegenerate,  ///< rows repeated, scaled, summed; many of them active at one point
};
inline constexpr int kProgramKinds = 4;

inline Eigen::VectorXd normal_vector(Eigen::Index size, Random& random) {
  Eigen::VectorXd v(size);
  for (double& value : v) value = random.normal();
  return v;
}

/// Rows by terms; their bounds give the point `inside` these slacks.
class RowBuilder {
 public:
  explicit RowBuilder(const Eigen::VectorXd& inside) : inside_(inside) {}
  void add(const std::vector<std::pair<int, double>>& terms, double slack) {
    double value = 0;
    for (const auto& [variable, factor] : terms) {
      entries_.emplace_back(static_cast<int>(bounds_.size()), variable, factor);
      value += factor * inside_[variable];
    }
    bounds_.push_back(value - slack);
  }
  [[nodiscard]] LinearConstraints build() const {
    LinearConstraints constraints;
    constraints.normals.resize(static_cast<int>(bounds_.size()), static_cast<int>(inside_.size()));
    constraints.normals.setFromTriplets(entries_.begin(), entries_.end());
    constraints.bounds =
        Eigen::Map<const Eigen::VectorXd>(bounds_.data(), static_cast<int>(bounds_.size()));
    return constraints;
  }

 private:
  Eigen::VectorXd inside_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<double> bounds_;
};

inline std::vector<std::pair<int, double>> random_terms(int variables, bool dense, Random& random) {
  std::vector<std::pair<int, double>> terms;
  if (dense) {
    for (int v = 0; v < variables; ++v) terms.emplace_back(v, random.normal());
    return terms;
  }
  const int count = std::min(variables, 2 + static_cast<int>(random.index(3)));
  for (int t = 0; t < count; ++t) {
    terms.emplace_back(static_cast<int>(random.index(static_cast<std::size_t>(variables))),
                       random.normal());
  }
  return terms;
}

/// Neighbours of a lattice with about `variables` cells do not rise, the first column is bounded.
inline LinearConstraints order_constraints(int variables) {
  const int columns = std::max(1, static_cast<int>(std::sqrt(variables)));
  RowBuilder builder(Eigen::VectorXd::Zero(variables));
  for (int c = 0; c < variables; ++c) {
    if (c + columns < variables) builder.add({{c, 1}, {c + columns, -1}}, 0);
    if (c % columns + 1 < columns && c + 1 < variables) builder.add({{c, 1}, {c + 1, -1}}, 0);
    if (c < columns) builder.add({{c, 1}}, -1);
  }
  return builder.build();
}

/// Feasible by construction, with the free minimum outside.
inline TestProgram random_program(ProgramKind kind, int variables, Random& random) {
  TestProgram program;
  if (kind == ProgramKind::kOrder) {
    program.constraints = order_constraints(variables);
    program.g = 2 * normal_vector(variables, random);
    return program;
  }
  const Eigen::VectorXd inside = normal_vector(variables, random);
  RowBuilder builder(inside);
  const bool dense = kind == ProgramKind::kDenseRows;
  const bool degenerate = kind == ProgramKind::kDegenerate;
  const int rows = degenerate ? (variables + 1) / 2 : variables + variables / 2;
  for (int i = 0; i < rows; ++i) {
    const bool tight = random.uniform() < (degenerate ? 0.5 : 0.1);
    const double slack = tight ? 0 : random.uniform();
    auto terms = random_terms(variables, dense, random);
    builder.add(terms, slack);
    if (!degenerate) continue;
    auto sum = terms;
    for (auto& [variable, factor] : terms) factor *= 3;
    builder.add(terms, 3 * slack);  // the same row again
    const auto other = random_terms(variables, false, random);
    sum.insert(sum.end(), other.begin(), other.end());
    builder.add(other, slack);
    builder.add(sum, 2 * slack);  // follows from the two
  }
  program.constraints = builder.build();
  program.g = inside + 2 * normal_vector(variables, random);
  return program;
}

}  // namespace bess
