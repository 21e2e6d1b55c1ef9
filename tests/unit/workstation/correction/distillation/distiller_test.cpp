#include "workstation/correction/distillation/distil.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/support/correction_cases.h"
#include "tests/support/student_nets.h"
#include "tests/support/teachers.h"
#include "workstation/base/random.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {
namespace {

Teacher untrained_teacher(Method method, std::uint64_t seed) {
  return network_teacher(method, {-30, 30, 11}, PriceMap(even_price_table()), seed);
}

Matrix some_visited(int count, std::uint64_t seed) {
  Random random(seed);
  const PriceMap map(even_price_table());
  Matrix visited(kNetworkInputs, count);
  for (int c = 0; c < count; ++c) {
    const LatticeState s = random_state(random);
    write_input(network_context(s.minute_of_quarter_hour, s.quarter_hour, s.context_class,
                                map(s.price_eur_per_mwh)),
                random.uniform(), visited.col(c).data());
  }
  return visited;
}

DistilOptions tiny_options() {
  DistilOptions options;
  options.epochs = 12;
  options.steps_per_epoch = 4;
  options.lattices_per_epoch = 8;
  options.lattice_prices = 8;
  options.lattice_socs = 6;
  options.visited_per_epoch = 512;
  options.seed = 5;
  return options;
}

const std::atomic<bool> kGoesOn{false};

TEST(Distiller, PlainDistillationFollowsTheTeacher) {
  for (const Method method : {Method::kDqn, Method::kC51}) {
    SCOPED_TRACE(method_name(method));
    const Teacher teacher = untrained_teacher(method, 7);
    const Matrix visited = some_visited(400, 8);
    DistilOptions options = tiny_options();
    options.correct = false;
    options.omega = 1;
    options.temperature_eur_per_h = 2000;
    Distiller distiller(teacher, visited, options);
    distiller.run(30, {}, 1, kGoesOn);
    const auto& curve = distiller.curve();
    ASSERT_EQ(curve.size(), 30U);
    EXPECT_EQ(curve.front().epoch, 1);
    EXPECT_EQ(curve.back().epoch, 30);
    EXPECT_LT(curve.back().visited_loss, 0.5 * curve.front().visited_loss);
    EXPECT_EQ(curve.back().correction_loss, 0) << "no layer, no correction loss";
  }
}

TEST(Distiller, CorrectedLossFalls) {
  const Teacher teacher = untrained_teacher(Method::kDqn, 7);
  const Matrix visited = some_visited(400, 8);
  const DistilOptions options = tiny_options();
  Distiller distiller(teacher, visited, options);
  distiller.run(30, {}, 1, kGoesOn);
  const auto& curve = distiller.curve();
  EXPECT_GT(curve.front().correction_loss, 0);
  EXPECT_LT(curve.back().correction_loss, 0.2 * curve.front().correction_loss);
}

TEST(Distiller, SameSeedAndThreadsGiveTheSameBits) {
  const Teacher teacher = untrained_teacher(Method::kC51, 9);
  const Matrix visited = some_visited(200, 10);
  for (const int threads : {1, 3}) {
    SCOPED_TRACE(threads);
    DistilOptions options = tiny_options();
    options.threads = threads;
    const std::vector<LatticeState> counterexamples{{3, 40, 6, 0, -500}, {14, 95, 12, 200, 1500}};
    Parameters results[2];
    for (Parameters& result : results) {
      Distiller distiller(teacher, visited, options);
      distiller.run(3, {}, 1, kGoesOn);
      distiller.run(2, counterexamples, 1.4, kGoesOn);
      result = distiller.parameters();
    }
    EXPECT_TRUE(std::ranges::equal(results[0], results[1]));
    EXPECT_TRUE(results[0].allFinite());
  }
}

TEST(Distiller, InterruptionReturns) {
  const Teacher teacher = untrained_teacher(Method::kDqn, 9);
  const Matrix visited = some_visited(50, 10);
  const std::atomic<bool> interrupted{true};
  DistilOptions options = tiny_options();
  options.epochs = 1'000'000;
  Distiller distiller(teacher, visited, options);
  const Parameters before = distiller.parameters();
  distiller.run(options.epochs, {}, 1, interrupted);
  EXPECT_TRUE(distiller.curve().empty());
  EXPECT_EQ(distiller.parameters(), before);
  const CorrectionResult result = correct_and_prove(teacher, visited, options, interrupted);
  EXPECT_TRUE(result.rounds.empty()) << "no proof after an interruption";
  EXPECT_FALSE(std::holds_alternative<ProvedStudent>(result.verdict));
}

TEST(PolicyLoss, HandCases) {
  Eigen::MatrixXd even = Eigen::MatrixXd::Zero(3, 1);
  EXPECT_NEAR(log_softmax(even)(1, 0), -std::log(3.0), 1e-15);
  EXPECT_DOUBLE_EQ(kl_divergence(log_softmax(even), log_softmax(even)), 0);
  Eigen::MatrixXd q(3, 1);
  q << std::log(0.5), std::log(0.25), std::log(0.25);
  // sum 1/3 log(1/3 / q)
  EXPECT_NEAR(kl_divergence(log_softmax(even), log_softmax(q)),
              -std::log(3.0) + (std::log(2.0) + 2 * std::log(4.0)) / 3, 1e-14);
}

TEST(PolicyLoss, LogSoftmaxHandlesHugeLogits) {
  Eigen::MatrixXd huge(3, 2);
  huge << 1e4, -1e4, 0, 0, -1e4, 1e4;
  const Eigen::MatrixXd log_p = log_softmax(huge);
  EXPECT_TRUE(log_p.allFinite());
  EXPECT_DOUBLE_EQ(log_p(0, 0), 0);
  EXPECT_DOUBLE_EQ(log_p(2, 0), -2e4);
  EXPECT_TRUE(std::isfinite(kl_divergence(log_p, log_p.rowwise().reverse())));
  EXPECT_TRUE(kl_gradient_first(log_p, log_p.rowwise().reverse()).allFinite());
}

TEST(PolicyLoss, GradientsAreTheDerivatives) {
  constexpr double kStep = 1e-6;
  Random random(302);
  const Eigen::MatrixXd p = random_logits(7, random, 2);
  const Eigen::MatrixXd q = random_logits(7, random, 2);
  const Eigen::MatrixXd log_p = log_softmax(p);
  const Eigen::MatrixXd log_q = log_softmax(q);
  const auto expect_derivative = [](const Eigen::MatrixXd& at, const Eigen::MatrixXd& gradient,
                                    const std::function<double(const Eigen::MatrixXd&)>& loss) {
    for (Eigen::Index k = 0; k < at.size(); ++k) {
      Eigen::MatrixXd up = at;
      Eigen::MatrixXd down = at;
      up.reshaped()[k] += kStep;
      down.reshaped()[k] -= kStep;
      EXPECT_NEAR(gradient.reshaped()[k], (loss(up) - loss(down)) / (2 * kStep), 1e-8) << k;
    }
  };
  expect_derivative(p, kl_gradient_first(log_p, log_q),
                    [&](const auto& z) { return kl_divergence(log_softmax(z), log_q); });
  expect_derivative(q, kl_gradient_second(log_p, log_q),
                    [&](const auto& z) { return kl_divergence(log_p, log_softmax(z)); });
}

}  // namespace
}  // namespace bess
