// Whatever the weights inside the bounds, the integer student is monotone; without them it is not.
#include "workstation/correction/distillation/monotone_distil.h"

#include <gtest/gtest.h>

#include "tests/support/student_nets.h"
#include "workstation/correction/student/verify.h"

namespace bess {
namespace {

/// Contexts with a pair of neighbours at which the action rises with price or SoC.
int rising_contexts(const StudentNet& net, std::uint64_t seed) {
  constexpr int kContexts = 4;
  Random random(seed);
  int rising = 0;
  std::vector<std::int8_t> grid;
  for (int c = 0; c < kContexts; ++c) {
    const LatticeState s = random_state(random);
    fill_action_grid(net, s.minute_of_quarter_hour, s.quarter_hour, s.context_class, true, grid);
    bool rises = false;
    for (int soc = 0; soc < kSocCount; ++soc) {
      for (int price = 0; price < kPriceCount; ++price) {
        const int at = soc * kPriceCount + price;
        if (price > 0 && grid[at] > grid[at - 1]) rises = true;
        if (soc > 0 && grid[at] > grid[at - kPriceCount]) rises = true;
      }
    }
    rising += rises ? 1 : 0;
  }
  return rising;
}

/// Large weights of any size, so that units saturate on both sides.
Parameters wild_parameters(std::uint64_t seed) {
  Random random(seed);
  Parameters parameters(kStudentShape.parameter_count());
  for (float& p : parameters)
    p = static_cast<float>(random.normal() * (random.uniform() < 0.2 ? 4 : 0.5));
  return parameters;
}

TEST(SignBounds, EveryStudentInsideIsMonotone) {
  const SignBounds bounds = SignBounds::monotone();
  const PriceMap map(even_price_table());
  int with_all_actions = 0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Parameters parameters = wild_parameters(seed);
    seed % 2 == 0 ? bounds.clamp(parameters) : bounds.reflect(parameters);
    ASSERT_TRUE(bounds.contain(parameters));
    const StudentNet net = quantise_student(parameters, map, kSaturation);
    EXPECT_EQ(rising_contexts(net, seed), 0) << seed;
    Random random(seed);
    bool seen[kActionCount] = {};
    for (int i = 0; i < 2'000; ++i) seen[static_cast<int>(net.decide(random_state(random)))] = true;
    with_all_actions += seen[0] && seen[2] ? 1 : 0;
  }
  EXPECT_GT(with_all_actions, 0) << "monotone because it never changes its mind proves nothing";
}

TEST(SignBounds, OutsideTheStudentIsNot) {
  const PriceMap map(even_price_table());
  int rising = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Parameters parameters = wild_parameters(seed);
    EXPECT_FALSE(SignBounds::monotone().contain(parameters));
    EXPECT_TRUE(SignBounds::none().contain(parameters));
    rising += rising_contexts(quantise_student(parameters, map, kSaturation), seed);
  }
  EXPECT_GT(rising, 0);
}

/// One wrong sign on each way from an input to the logits is enough to be found.
TEST(SignBounds, AWrongSignAnywhereIsOutside) {
  const SignBounds bounds = SignBounds::monotone();
  Parameters inside = initial_parameters(kStudentShape, 3);
  bounds.reflect(inside);
  int bound_weights = 0;
  for (Eigen::Index i = 0; i < inside.size(); ++i) {
    Parameters other = inside;
    other[i] = 1;
    const bool up = bounds.contain(other);
    other[i] = -1;
    bound_weights += up && bounds.contain(other) ? 0 : 1;
  }
  // Price and SoC into every unit of hidden 1, 40 of those into all of hidden 2, and all of the
  // head.
  EXPECT_EQ(bound_weights, 2 * kStudentHidden1 + 40 * kStudentHidden2 + 3 * kStudentHidden2);
}

}  // namespace
}  // namespace bess
