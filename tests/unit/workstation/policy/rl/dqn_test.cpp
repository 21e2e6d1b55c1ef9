#include "workstation/policy/rl/dqn.h"

#include "tests/unit/workstation/policy/nn/reference_net.h"
#include "workstation/policy/rl/learner.h"

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

INSTANTIATE_TEST_SUITE_P(Batches, DqnGradient,
                         testing::Values(DqnCase{"even", 0.999, {{200, 200, 200}, 2}},
                                         DqnCase{"uneven", 0.99, {{700, 2, 50}, 2}},
                                         DqnCase{"no_discharge", 0.9, {{0, 60, 20}, 10}},
                                         DqnCase{"only_idle", 0.5, {{0, 31, 0}, 1}},
                                         DqnCase{"all_terminal", 0.9, {{10, 10, 10}, 1, 1.1}}),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace bess
