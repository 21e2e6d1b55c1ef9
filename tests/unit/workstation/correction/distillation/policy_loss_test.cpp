#include "workstation/correction/distillation/distil.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "workstation/base/random.h"

namespace bess {
namespace {

Eigen::MatrixXd random_logits(Eigen::Index columns, Random& random) {
  Eigen::MatrixXd logits(3, columns);
  for (double& z : logits.reshaped()) z = 2 * random.normal();
  return logits;
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

TEST(PolicyLoss, LogSoftmaxStandsHugeLogits) {
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
  const Eigen::MatrixXd p = random_logits(7, random);
  const Eigen::MatrixXd q = random_logits(7, random);
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
