#include "workstation/policy/rl/c51.h"

#include "tests/unit/workstation/policy/nn/reference_net.h"
#include "workstation/policy/rl/learner.h"

namespace bess {
namespace {

TEST(DqnGradient, OfTheRealShapeIsTheReference) {
  const struct {
    const char* name;
    double gamma;
    BatchRecipe recipe;
  } cases[] = {{"even", 0.999, {{200, 200, 200}, 2}},
               {"uneven", 0.99, {{700, 2, 50}, 2}},
               {"no discharge", 0.9, {{0, 60, 20}, 10}},
               {"only idle", 0.5, {{0, 31, 0}, 1}},
               {"all terminal", 0.9, {{10, 10, 10}, 1, 1.1}}};
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
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
}

}  // namespace
}  // namespace bess
