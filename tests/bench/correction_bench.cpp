// The projection: exact isotonic regression with bounds, and NLopt on the same problem where that is bearable;
// the general program on an order of so many variables and on rows of any kind, and cvxopt on the same.
#include <fmt/core.h>
#include <nlopt.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>

#include "tests/bench/registry.h"
#include "tests/support/cvxopt_peer.h"
#include "workstation/base/random.h"
#include "workstation/correction/isotonic.h"

namespace bess {
namespace {

std::vector<double> noisy_slope(int rows, int columns) {
  Random random(3);
  std::vector<double> y;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      y.push_back(3.0 - 6.0 * i / rows - 1.0 * j / columns + 0.5 * random.normal());
    }
  }
  return y;
}

void exact_projection(benchmark::State& state, int rows, int columns) {
  const std::vector<double> y = noisy_slope(rows, columns);
  std::vector<double> x(y.size());
  IsotonicProjection projection(rows, columns);
  const RowBounds bounds{1, 1.0, 1, -1.0};
  for (auto _ : state) {
    projection.project(y, bounds, x);
    benchmark::DoNotOptimize(x.data());
  }
}

double squared_distance(const std::vector<double>& x, std::vector<double>& gradient, void* data) {
  const auto& y = *static_cast<const std::vector<double>*>(data);
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += (x[i] - y[i]) * (x[i] - y[i]);
    if (!gradient.empty()) gradient[i] = 2 * (x[i] - y[i]);
  }
  return sum;
}

struct Order {
  unsigned first, second;  ///< x[second] - x[first] <= 0
};

double order_constraint(const std::vector<double>& x, std::vector<double>& gradient, void* data) {
  const Order& order = *static_cast<const Order*>(data);
  if (!gradient.empty()) {
    std::ranges::fill(gradient, 0.0);
    gradient[order.first] = -1;
    gradient[order.second] = 1;
  }
  return x[order.second] - x[order.first];
}

void nlopt_projection(benchmark::State& state, unsigned rows, unsigned columns) {
  std::vector<double> y = noisy_slope(static_cast<int>(rows), static_cast<int>(columns));
  std::vector<Order> orders;
  for (unsigned i = 0; i < rows; ++i) {
    for (unsigned j = 0; j < columns; ++j) {
      if (i + 1 < rows) orders.push_back({i * columns + j, (i + 1) * columns + j});
      if (j + 1 < columns) orders.push_back({i * columns + j, i * columns + j + 1});
    }
  }
  for (auto _ : state) {
    nlopt::opt solver(nlopt::LD_SLSQP, rows * columns);
    solver.set_min_objective(squared_distance, &y);
    for (Order& order : orders) solver.add_inequality_constraint(order_constraint, &order, 1e-9);
    std::vector<double> low(y.size(), -1e3);
    std::vector<double> high(y.size(), 1e3);
    for (unsigned j = 0; j < columns; ++j) {
      low[j] = 1.0;
      high[(rows - 1) * columns + j] = -1.0;
    }
    solver.set_lower_bounds(low);
    solver.set_upper_bounds(high);
    solver.set_xtol_rel(1e-9);
    std::vector<double> x(y.size());
    for (unsigned c = 0; c < x.size(); ++c) x[c] = std::clamp(0.0, low[c], high[c]);
    double objective = 0;
    solver.optimize(x, objective);
    benchmark::DoNotOptimize(objective);
  }
}

/// A projection, solved and differentiated; cvxopt only solves.
void quadratic_program(benchmark::State& state, ProgramKind kind, int variables) {
  Random random(4);
  const std::vector<TestProgram> programs{random_program(kind, variables, random)};
  const TestProgram& program = programs.front();
  QuadraticProgram solver = program.solver();
  const Eigen::VectorXd gradient_x = normal_vector(variables, random);
  Eigen::VectorXd gradient(variables);
  for (auto _ : state) {
    if (solver.solve(program.g) != QuadraticOutcome::kSolved) state.SkipWithError("not solved");
    solver.backward(gradient_x, gradient);
    benchmark::DoNotOptimize(gradient.data());
  }
  constexpr int kPeerSolutions = 15;
  const std::optional<std::vector<double>> peer = CvxoptPeer(programs).median_us(kPeerSolutions);
  if (!peer) {
    std::fprintf(stderr,
                 "bess-bench: no cvxopt to compare with (tools/setup --test installs it)\n");
  }
  report_peer(state, "cvxopt", peer ? peer->front() : std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

void register_correction_benchmarks() {
  constexpr int kRepetitions = 5;
  add_benchmark("projection-32x16", benchmark::kMicrosecond, kRepetitions,
                [](benchmark::State& state) { exact_projection(state, 32, 16); });
  add_benchmark("projection-8x8", benchmark::kMicrosecond, kRepetitions,
                [](benchmark::State& state) { exact_projection(state, 8, 8); });
  add_benchmark("projection-8x8@nlopt-slsqp", benchmark::kMicrosecond, 1,
                [](benchmark::State& state) { nlopt_projection(state, 8, 8); });
  for (const int variables : {24, 64, 128}) {
    add_benchmark(fmt::format("qp-order-{}", variables), benchmark::kMicrosecond, kRepetitions,
                  [variables](benchmark::State& state) {
                    quadratic_program(state, ProgramKind::kOrder, variables);
                  });
    add_benchmark(fmt::format("qp-rows-{}", variables), benchmark::kMicrosecond, kRepetitions,
                  [variables](benchmark::State& state) {
                    quadratic_program(state, ProgramKind::kSparseRows, variables);
                  });
  }
}

}  // namespace bess
