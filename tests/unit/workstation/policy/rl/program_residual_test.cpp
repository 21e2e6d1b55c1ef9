// Residual on the stochastic program: it starts as the program, and learns the program's error.
#include "workstation/policy/rl/teacher.h"

#include <memory>
#include <numeric>

#include "tests/support/teachers.h"
#include "tests/unit/workstation/policy/nn/reference_net.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/policy/rl/learner.h"
#include "workstation/policy/rl/train.h"

namespace bess {
namespace {

const MarketSteps& market() {
  static const MarketSteps simulated = simulated_market({2023, 1, 1}, 40);
  return simulated;
}

const std::shared_ptr<const StochasticProgram>& market_program() {
  static const std::shared_ptr<const StochasticProgram> program = program_of(market());
  return program;
}

Teacher program_teacher() {
  const PriceMap map = PriceMap::fit(observed_training_prices(market()));
  return program_teacher(market(), map, market_program());
}

/// As before the first step.
Teacher beginner(Method method, const Support& support) {
  Teacher teacher = program_teacher();
  teacher.method = method;
  teacher.support = support;
  teacher.shape = teacher_shape(method, support);
  teacher.parameters = initial_parameters(teacher.shape, 5);
  begin_at_zero(method, support, teacher.shape, teacher.parameters);
  return teacher;
}

// ---- Before the first step -------------------------------------------------------------------

struct Beginning {
  Method method;
  Support support;
};

class BeforeTheFirstStep : public testing::TestWithParam<Beginning> {};

TEST_P(BeforeTheFirstStep, ItDecidesEveryVisitedStateAsTheProgram) {
  const auto& [method, support] = GetParam();
  const Teacher teacher = beginner(method, support);
  const Teacher program = program_teacher();
  expect_same_decisions(TeacherPolicy(teacher), TeacherPolicy(program),
                        std::span(market().steps).first(std::size_t{7} * 720));
}

TEST(BeforeTheFirstLesson, ItTeachesEveryVisitedStateAsTheProgram) {
  const Teacher teacher = beginner(Method::kC51, {-0.37F, 0.37F, 51});
  const Teacher program = program_teacher();
  const Matrix visited = visited_inputs(teacher, market(), {}, {});
  EXPECT_EQ(visited, visited_inputs(program, market(), {}, {}));
  MlpTile tile;
  EXPECT_EQ(teacher.action_values(visited, tile), program.action_values(visited, tile));
}

TEST_P(BeforeTheFirstStep, WhatItAddsIsAPointMassAtZero) {
  const auto& [method, support] = GetParam();
  const Teacher teacher = beginner(method, support);
  const ConstMlp net(teacher.shape, teacher.parameters.data());
  EXPECT_EQ(net.w3.cwiseAbs().maxCoeff(), 0);
  if (method != Method::kC51) return;
  Matrix p = net.b3.reshaped(support.count, kActionCount);
  softmax_columns(p);
  for (int a = 0; a < kActionCount; ++a) {
    EXPECT_NEAR(p(support.count / 2, a), 1 - kPriorMass, 1e-5);
    EXPECT_NEAR(support.atom(support.count / 2), 0, 1e-6 * support.v_max);
  }
}

INSTANTIATE_TEST_SUITE_P(Networks, BeforeTheFirstStep,
                         testing::Values(Beginning{Method::kC51, {-0.37F, 0.37F, 51}},
                                         Beginning{Method::kC51, {-11, 11, 101}},
                                         Beginning{Method::kC51, {-1.7F, 1.7F, 3}},
                                         Beginning{Method::kDqn, {-1, 1, 51}}));

// ---- Rewards ----------------------------------------------------------------

TEST(ProgramResidual, RewardIsTheProgramsErrorInOneStep) {
  const auto& program = market_program();
  const PriceMap map = straight_price_map();
  const TrainingMarket shaped(market(), map, {}, Horizon::kContinuing, {.program = {program}});
  const TrainingMarket plain(market(), map, {}, Horizon::kContinuing, {});
  const double unit = learned_per_eur({});
  const MarketStep* step = market().of(market().days_of(Split::kTrain)[0]).data();
  std::vector<double> centres;  // the subtracted baseline, equal for a whole day
  for (std::size_t i = 0; i < 700; i += 7) {
    for (const double soc : {0.1, 0.1003, 0.4321, 0.998, 1.0}) {
      const auto here = program->action_values(StochasticProgram::market_state_of(step[i]), soc);
      for (int a = 0; a < kActionCount; ++a) {
        Transition t{}, paid{};
        const double next_soc = shaped.make_transition(i, soc, static_cast<Action>(a), t);
        (void)plain.make_transition(i, soc, static_cast<Action>(a), paid);
        const auto next =
            program->action_values(StochasticProgram::market_state_of(step[i + 1]), next_soc);
        const double best = *std::ranges::max_element(next);
        for (int b = 0; b < kActionCount; ++b) {
          EXPECT_NEAR(t.next_advantage[b], (next[b] - best) * unit, 2e-4);
        }
        EXPECT_LE(*std::ranges::max_element(t.next_advantage), 0);
        centres.push_back(double{paid.reward} + (program->gamma() * best - here[a]) * unit -
                          double{t.reward});
      }
    }
  }
  const auto [least, most] = std::ranges::minmax(centres);
  EXPECT_LT(most - least, 5e-4);
}

TEST(ProgramResidual, RewardsAreCentredWhereTheProgramTradesAndSoIsMidnight) {
  const TrainingMarket training(market(), straight_price_map(), {}, Horizon::kContinuing,
                                {.program = {market_program()}});
  // Without a discount the returns are the rewards.
  const std::vector<float> rewards = training.residual_returns(0);
  ASSERT_EQ(rewards.size(), training.step_count());
  EXPECT_NEAR(std::accumulate(rewards.begin(), rewards.end(), 0.0), 0, 0.02);
  double midnights = 0;
  double largest = 0;
  for (std::size_t d = 0; d + 1 < training.days().size(); ++d) {
    const auto& day = training.days()[d];
    if (day.count < 720) continue;  // the last of a block has no successor
    midnights += double{rewards[day.first + day.count - 1]};
    largest = std::max(largest, std::abs(double{rewards[day.first + day.count - 1]}));
  }
  EXPECT_NEAR(midnights, 0, 0.02);
  EXPECT_LT(largest, 1) << "values of one day more are worth thousands of euros";
}

// ---- Learning --------------------------------------------------------------------------------

/// Each quarter-hour shows 20 or 80 EUR/MWh, by chance; the paid price is that one, or its
/// complement to 100.
MarketSteps two_prices(bool inverted) {
  MarketSteps steps = market();
  Random random(72);
  double price = 20;
  for (MarketStep& step : steps.steps) {
    if (step.minute_of_quarter_hour < kMinutesPerStep) price = random.index(2) == 0 ? 20 : 80;
    step.observed_eur_per_mwh = price;
    step.paid_eur_per_mwh = inverted ? 100 - price : price;
    step.level_centi_eur_per_mwh = 5000;
    step.observed_age_min = 0;
  }
  return steps;
}

TEST(ProgramResidual, LearnsWhatTheProgramHasWrong) {
  const MarketSteps truth = two_prices(true);
  const auto program = program_of(two_prices(false));
  const PriceMap map = PriceMap::fit(observed_training_prices(truth));
  const ContextClasses context{};
  const TrainingMarket training(truth, map, {}, Horizon::kContinuing, {.program = {program}},
                                context);
  const Support support{-0.4F, 0.4F, 41};
  Learner learner(Method::kC51, support, 0, 3, 1, 1e4);  // the reach of one step: known by hand
  for (Parameters* p : {&learner.online(), &learner.target()}) {
    begin_at_zero(Method::kC51, support, learner.shape(), *p);
  }
  Teacher teacher{Method::kC51,     support, learner.shape(), map,
                  learner.online(), "",      program,         context};
  const MarketStep* cheap = nullptr;
  for (const MarketStep& step : truth.steps) {
    if (step.observed_eur_per_mwh == 20 && step.minute_of_quarter_hour == 6) cheap = &step;
  }
  ASSERT_NE(cheap, nullptr);
  EXPECT_EQ(TeacherPolicy(teacher).decide(*cheap, 0, 0.5), Action::kCharge);
  Random random(73);
  std::vector<Transition> drawn;
  MiniBatch batch;
  for (int step = 0; step < 400; ++step) {
    draw_counterfactual(training, 384, {}, random, drawn);
    fill_minibatch(drawn, batch);
    (void)learner.step(batch, 1e-3, 1);
  }
  teacher.parameters = learner.online();
  // It pays 80 where the program expects 20: 4 MW lose 240 EUR/h by charging, and earn the same by
  // discharging.
  Matrix x(kNetworkInputs, 1);
  write_input(network_context(*cheap, map, context), 0.5, x.data());
  MlpTile tile;
  const Matrix added = teacher.network_values(x, tile);
  EXPECT_NEAR(added(2) - added(1), -0.024, 0.006);
  EXPECT_NEAR(added(0) - added(1), 0.024, 0.006);
  EXPECT_NE(TeacherPolicy(teacher).decide(*cheap, 0, 0.5), Action::kCharge);
}

}  // namespace
}  // namespace bess
