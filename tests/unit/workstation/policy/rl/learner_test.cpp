#include "workstation/policy/rl/learner.h"

#include "tests/unit/workstation/policy/nn/reference_net.h"

namespace bess {
namespace {

constexpr Support kSupport{-15, 15, 21};
constexpr double kGamma = 0.99;
constexpr double kRate = 1e-3;
constexpr double kTau = 0.2;

/// Several tiles of each action, none of them full.
MiniBatch batch_of(std::uint64_t seed) {
  Random random(seed);
  std::vector<Transition> transitions(1700);
  for (Transition& t : transitions) {
    t = Transition{};
    for (float& x : t.state) x = static_cast<float>(random.uniform());
    for (float& x : t.next_state) x = static_cast<float>(random.uniform());
    t.reward = static_cast<float>(3 * random.normal());
    t.action = static_cast<std::int32_t>(random.index(kActionCount));
    t.terminal = random.uniform() < 0.01 ? 1 : 0;
  }
  return minibatch_of(transitions);
}

class LearnerOf : public testing::TestWithParam<Method> {
 protected:
  static Parameters after_steps(int threads, std::uint64_t seed, int steps) {
    Learner learner(GetParam(), kSupport, kGamma, seed, threads);
    for (int step = 0; step < steps; ++step) {
      learner.step(batch_of(100 + static_cast<std::uint64_t>(step)), kRate, kTau);
    }
    return learner.online();
  }
};

TEST_P(LearnerOf, SameSeedAndThreadsSameBits) {
  const Parameters first = after_steps(2, 9, 20);
  EXPECT_TRUE(first.allFinite());
  EXPECT_EQ(first, after_steps(2, 9, 20));
  EXPECT_NE(first, after_steps(2, 10, 20));
}

TEST_P(LearnerOf, ThreadsChangeOnlyTheRounding) {
  const MiniBatch batch = batch_of(1);
  Learner one(GetParam(), kSupport, kGamma, 9, 1);
  const double loss = one.compute_gradient(batch).loss;
  for (const int threads : {2, 3, 9}) {  // nine: more threads than tiles
    Learner many(GetParam(), kSupport, kGamma, 9, threads);
    EXPECT_NEAR(many.compute_gradient(batch).loss, loss, 1e-6 * loss) << threads;
    EXPECT_LT(relative_l2(many.gradient(), to_doubles(one.gradient())), 2e-6) << threads;
  }
  // Adam divides by small moments, so rounding grows; still far below the learnt values.
  const Parameters start = Learner(GetParam(), kSupport, kGamma, 9, 1).online();
  const Parameters single = after_steps(1, 9, 20);
  const Parameters twin = after_steps(2, 9, 20);
  EXPECT_LT((single - twin).norm(), 0.02F * (single - start).norm());
}

TEST_P(LearnerOf, StepIsGradientAdamAndBlend) {
  const MiniBatch batch = batch_of(2);
  Learner learner(GetParam(), kSupport, kGamma, 9, 2);
  Learner twin(GetParam(), kSupport, kGamma, 9, 2);
  const Parameters start = learner.online();
  const double loss = twin.compute_gradient(batch).loss;
  EXPECT_EQ(learner.step(batch, kRate, kTau).loss, loss);
  Parameters expected = start;
  Adam adam(start.size());
  adam.update(expected, twin.gradient(), static_cast<float>(kRate));
  EXPECT_EQ(learner.online(), expected);
  const Parameters blended =
      static_cast<float>(kTau) * expected + static_cast<float>(1 - kTau) * start;
  EXPECT_LT((learner.target() - blended).cwiseAbs().maxCoeff(), 1e-6F);
  learner.step(batch, kRate, 1);
  EXPECT_LT((learner.target() - learner.online()).cwiseAbs().maxCoeff(), 1e-6F);
}

INSTANTIATE_TEST_SUITE_P(Methods, LearnerOf, testing::Values(Method::kC51, Method::kDqn),
                         [](const auto& instance) {
                           return std::string(method_name(instance.param));
                         });

TEST(MiniBatches, AreGroupedByActionAndStable) {
  std::vector<Transition> transitions;
  const int actions[] = {2, 0, 2, 0, 0, 2};  // no idle
  for (int i = 0; i < 6; ++i) {
    Transition t{};
    t.action = actions[i];
    t.reward = static_cast<float>(i);
    t.terminal = i == 4 ? 1 : 0;
    for (int k = 0; k < kNetworkInputs; ++k) {
      t.state[k] = static_cast<float>(10 * i + k);
      t.next_state[k] = static_cast<float>(100 * i + k);
    }
    transitions.push_back(t);
  }
  const MiniBatch batch = minibatch_of(transitions);
  EXPECT_EQ(batch.size(), 6);
  EXPECT_EQ(batch.group_end[0], 3);
  EXPECT_EQ(batch.group_end[1], 3);
  EXPECT_EQ(batch.group_end[2], 6);
  EXPECT_EQ(batch.group_begin(0), 0);
  EXPECT_EQ(batch.group_begin(2), 3);
  const int order[] = {1, 3, 4, 0, 2, 5};
  for (Eigen::Index at = 0; at < 6; ++at) {
    const int i = order[at];
    EXPECT_EQ(batch.reward[at], static_cast<float>(i));
    EXPECT_EQ(batch.terminal[static_cast<std::size_t>(at)], i == 4 ? 1 : 0);
    EXPECT_EQ(batch.state(4, at), static_cast<float>(10 * i + 4));
    EXPECT_EQ(batch.next_state(3, at), static_cast<float>(100 * i + 3));
  }
}

}  // namespace
}  // namespace bess
