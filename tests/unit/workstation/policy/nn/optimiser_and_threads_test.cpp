#include <gtest/gtest.h>

#include <atomic>

#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/nn/thread_team.h"

namespace bess {
namespace {

// By hand, learning rate 0.1:
//   step 1  g = (2, -0.5)  the bias corrections cancel: moves by 0.1 sign(g)
//   step 2  g = (1, 0.5)   m = (0.28, 0.005) / 0.19, v = (0.004996, 0.00049975) / 0.001999
//                          moves by 0.1 (1.4736842 / 1.5809016, 0.0263158 / 0.5)
TEST(Adam, TwoStepsByHand) {
  Adam adam(3);
  Parameters parameters(3);
  parameters << 1, -1, 7;
  Parameters gradient(3);
  gradient << 2, -0.5F, 0;
  adam.update(parameters, gradient, 0.1F);
  EXPECT_NEAR(parameters[0], 0.9, 1e-6);
  EXPECT_NEAR(parameters[1], -0.9, 1e-6);
  gradient << 1, 0.5F, 0;
  adam.update(parameters, gradient, 0.1F);
  EXPECT_NEAR(parameters[0], 0.9 - 0.09321796, 1e-6);
  EXPECT_NEAR(parameters[1], -0.9 - 0.00526316, 1e-6);
  EXPECT_EQ(parameters[2], 7) << "no gradient, no move";
}

TEST(Adam, FirstStepOfATinyGradientIsTamedByEpsilon) {
  Adam adam(1);
  Parameters parameters = Parameters::Zero(1);
  adam.update(parameters, Parameters::Constant(1, 1e-8F), 0.1F);
  EXPECT_NEAR(parameters[0], -0.05, 1e-5);
}

class Team : public testing::TestWithParam<int> {};

TEST_P(Team, RunsEachIndexOnceAndOthersMaySeeIt) {
  constexpr int kRuns = 500;
  ThreadTeam team(GetParam());
  EXPECT_EQ(team.size(), GetParam());
  std::vector<int> calls(static_cast<std::size_t>(GetParam()), 0);  // own slot each, no lock
  for (int run = 1; run <= kRuns; ++run) {
    team.run([&](int index) { ++calls[static_cast<std::size_t>(index)]; });
    for (const int count : calls) ASSERT_EQ(count, run);
  }
}

TEST_P(Team, MemberZeroIsTheCaller) {
  ThreadTeam team(GetParam());
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<int> strangers = 0;
  team.run([&](int index) {
    if ((std::this_thread::get_id() == caller) != (index == 0)) ++strangers;
  });
  EXPECT_EQ(strangers, 0);
}

TEST_P(Team, EndsWithoutWork) { const ThreadTeam team(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Sizes, Team, testing::Values(1, 2, 3, 7));

}  // namespace
}  // namespace bess
