// Projection benchmarks: exact isotonic regression with bounds against NLopt and the general
// program where feasible; the general program on an order of so many variables and on general rows,
// against cvxopt.
#include <fmt/core.h>
#include <nlopt.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <limits>

#include "tests/bench/registry.h"
#include "tests/support/cvxopt_peer.h"
#include "workstation/base/random.h"
#include "workstation/correction/distillation/correction_layer.h"

namespace bess {
namespace {

constexpr int kRepetitions = 5;
/// Short turns, alternating with a peer process, because the pace of a shared machine changes
/// within seconds.
constexpr int kTurns = 11;
constexpr double kTurnS = 0.1;
constexpr std::size_t kGeneralSolutions = 15;

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

/// The same projection as rows of the general program: no cell exceeds its predecessor in row or
/// column, the first row is at least the lower bound, the last at most the upper.
LinearConstraints order_with_bounds(int rows, int columns, const RowBounds& bounds) {
  const int cells = rows * columns;
  RowBuilder builder(Eigen::VectorXd::Zero(cells));
  for (int c = 0; c < cells; ++c) {
    if (c + columns < cells) builder.add({{c, 1}, {c + columns, -1}}, 0);
    if ((c + 1) % columns != 0) builder.add({{c, 1}, {c + 1, -1}}, 0);
    if (c < columns) builder.add({{c, 1}}, -bounds.lower);
    if (c >= cells - columns) builder.add({{c, -1}}, bounds.upper);
  }
  return builder.build();
}

/// The isotonic projection and the general program on the same problem, alternating.
void isotonic_and_general(benchmark::State& state, int rows, int columns) {
  const std::vector<double> y = noisy_slope(rows, columns);
  const Eigen::VectorXd g =
      Eigen::Map<const Eigen::VectorXd>(y.data(), static_cast<Eigen::Index>(y.size()));
  const RowBounds bounds{1, 1.0, 1, -1.0};
  std::vector<double> x(y.size());
  IsotonicProjection projection(rows, columns);
  QuadraticProgram program(order_with_bounds(rows, columns, bounds));
  std::vector<double> general_us;
  for (auto _ : state) {
    projection.project(y, bounds, x);
    benchmark::DoNotOptimize(x.data());
    if (general_us.size() >= kGeneralSolutions) continue;
    state.PauseTiming();
    const auto start = std::chrono::steady_clock::now();
    const bool solved = program.solve(g) == QuadraticOutcome::kSolved;
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    general_us.push_back(took.count());
    const Eigen::Map<const Eigen::VectorXd> exact(x.data(), g.size());
    if (!solved || (program.x() - exact).cwiseAbs().maxCoeff() > 1e-9) {
      state.SkipWithError("the two answers differ");
    }
    state.ResumeTiming();
  }
  std::ranges::sort(general_us);
  report_peer(state, "general program", general_us[general_us.size() / 2]);
}

double thread_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// A program solved by ours and by cvxopt; `gradient_us` is the derivative, which cvxopt lacks. CPU
/// time of one thread, which is least sensitive to other load.
void quadratic_program(benchmark::State& state, ProgramKind kind, int variables) {
  Random random(4);
  const std::vector<TestProgram> programs{random_program(kind, variables, random)};
  const TestProgram& program = programs.front();
  QuadraticProgram solver = program.solver();
  const Eigen::VectorXd gradient_x = normal_vector(variables, random);
  Eigen::VectorXd gradient(variables);
  double gradient_s = 0;
  for (auto _ : state) {
    const double start = thread_cpu_s();
    if (solver.solve(program.g) != QuadraticOutcome::kSolved) state.SkipWithError("not solved");
    const double solved = thread_cpu_s();
    solver.backward(gradient_x, gradient);
    benchmark::DoNotOptimize(gradient.data());
    gradient_s += thread_cpu_s() - solved;
    state.SetIterationTime(solved - start);
  }
  state.counters["gradient_us"] =
      benchmark::Counter(1e6 * gradient_s, benchmark::Counter::kAvgIterations);
  constexpr int kPeerSolutions = 15;
  const std::optional<std::vector<double>> peer = CvxoptPeer(programs).median_us(kPeerSolutions);
  if (!peer) {
    std::fprintf(stderr,
                 "bess-bench: no cvxopt to compare with (tools/setup --test installs it)\n");
  }
  report_peer(state, "cvxopt", peer ? peer->front() : std::numeric_limits<double>::quiet_NaN());
}

void add_quadratic_program(const std::string& name, ProgramKind kind, int variables) {
  benchmark_names().push_back(name);
  benchmark::RegisterBenchmark(
      name.c_str(),
      [kind, variables](benchmark::State& state) { quadratic_program(state, kind, variables); })
      ->Unit(benchmark::kMicrosecond)
      ->UseManualTime()
      ->MinTime(kTurnS)
      ->Repetitions(kTurns);
}

}  // namespace

void register_correction_benchmarks() {
  add_benchmark("projection-32x16", benchmark::kMicrosecond, kRepetitions,
                [](benchmark::State& state) { exact_projection(state, 32, 16); });
  add_benchmark("projection-8x8", benchmark::kMicrosecond, kRepetitions,
                [](benchmark::State& state) { exact_projection(state, 8, 8); });
  add_benchmark("projection-8x8@nlopt-slsqp", benchmark::kMicrosecond, 1,
                [](benchmark::State& state) { nlopt_projection(state, 8, 8); });
  for (const auto& [rows, columns] : {std::pair{8, 8}, std::pair{16, 8}, std::pair{32, 16}}) {
    add_benchmark(
        fmt::format("isotonic-{}x{}", rows, columns), benchmark::kMicrosecond, kRepetitions,
        [rows, columns](benchmark::State& state) { isotonic_and_general(state, rows, columns); });
  }
  for (const int variables : {24, 64, 128}) {
    add_quadratic_program(fmt::format("qp-order-{}", variables), ProgramKind::kOrder, variables);
    add_quadratic_program(fmt::format("qp-rows-{}", variables), ProgramKind::kSparseRows,
                          variables);
    add_quadratic_program(fmt::format("qp-dense-{}", variables), ProgramKind::kDenseRows,
                          variables);
  }
}

}  // namespace bess
