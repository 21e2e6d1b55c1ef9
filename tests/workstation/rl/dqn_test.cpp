#include "workstation/rl/dqn.h"

#include "tests/workstation/nn/plain_kernels.h"
#include "tests/workstation/nn/reference_net.h"
#include "tests/workstation/nn/tile_sums.h"
#include "workstation/rl/learner.h"

namespace bess {
namespace {

struct DqnCase {
  const char* name;
  double gamma;
  BatchRecipe recipe;
};

void PrintTo(const DqnCase& c, std::ostream* out) { *out << c.name; }

class DqnGradient : public testing::TestWithParam<DqnCase> {};

TEST_P(DqnGradient, OfTheRealShapeIsTheReference) {
  const DqnCase& c = GetParam();
  Learner learner(Method::kDqn, {-1, 1, 2}, c.gamma, 1, 2);
  learner.online() = random_parameters(learner.shape(), 51, 2);
  learner.target() = random_parameters(learner.shape(), 52, 2);
  const ReferenceNet online(learner.shape(), to_doubles(learner.online()));
  const ReferenceNet target(learner.shape(), to_doubles(learner.target()));
  Random random(53);
  const auto transitions = random_transitions(c.recipe, {}, online, target, random);
  const ReferenceLoss expected = reference_dqn(c.gamma, online, target, transitions);
  const Learner::StepResult result = learner.compute_gradient(minibatch_of(transitions));
  EXPECT_LT(std::abs(result.loss / expected.loss - 1), 1e-6) << result.loss;
  EXPECT_LT(relative_l2(learner.gradient(), expected.gradient), 1e-5);
  EXPECT_EQ(result.edge_mass_frac, 0);
}

TEST_P(DqnGradient, OfASmallShapeInTilesIsTheReference) {
  const DqnCase& c = GetParam();
  constexpr Eigen::Index kTile = 7;
  const MlpShape shape{5, 7, 6, kActionCount};
  const Parameters online_parameters = random_parameters(shape, 54, 2);
  const Parameters target_parameters = random_parameters(shape, 55, 2);
  const ReferenceNet online(shape, to_doubles(online_parameters));
  const ReferenceNet target(shape, to_doubles(target_parameters));
  Random random(56);
  const auto transitions = random_transitions(c.recipe, {}, online, target, random);
  const ReferenceLoss expected = reference_dqn(c.gamma, online, target, transitions);
  const MiniBatch batch = minibatch_of(transitions);
  const PackedPair nets(shape, online_parameters, target_parameters);
  for (const TileKernels* kernels : {&packet_kernels(), &plain_kernels()}) {
    SCOPED_TRACE(kernels->name);
    const auto step = nets.step(*kernels, batch, c.gamma);
    DqnTile tile;
    const auto [loss, gradient] = sum_of_tiles(
        shape, batch, kTile,
        [&](const auto& range, auto& sum) { return dqn_tile_gradient(step, range, tile, sum); });
    EXPECT_LT(std::abs(loss / static_cast<double>(transitions.size()) / expected.loss - 1), 1e-6);
    EXPECT_LT(relative_l2(gradient, expected.gradient), 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(Batches, DqnGradient,
                         testing::Values(DqnCase{"even", 0.999, {{200, 200, 200}, 2}},
                                         DqnCase{"uneven", 0.99, {{700, 2, 50}, 2}},
                                         DqnCase{"no_discharge", 0.9, {{0, 60, 20}, 10}},
                                         DqnCase{"only_idle", 0.5, {{0, 31, 0}, 1}},
                                         DqnCase{"all_terminal", 0.9, {{10, 10, 10}, 1, 1.1}}),
                         [](const auto& instance) { return instance.param.name; });

TEST(DqnReference, GradientIsTheDifferenceQuotientOfItsLoss) {
  const MlpShape shape{5, 7, 6, kActionCount};
  const ReferenceNet online(shape, to_doubles(random_parameters(shape, 57, 2)));
  const ReferenceNet target(shape, to_doubles(random_parameters(shape, 58, 2)));
  Random random(59);
  const auto batch = random_transitions({{5, 4, 3}, 2}, {}, online, target, random);
  const Doubles differences = finite_differences(shape, online.parameters, [&](const auto& net) {
    return reference_dqn(0.9, net, target, batch).loss;
  });
  const Doubles gradient = reference_dqn(0.9, online, target, batch).gradient;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    EXPECT_NEAR(gradient[i], differences[i], 1e-7) << i;
  }
}

}  // namespace
}  // namespace bess
