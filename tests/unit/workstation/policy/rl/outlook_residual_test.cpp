// Residual on the program that plans on day-ahead prices: it starts as that program, is rewarded
// with the program's error, and has no earlier information.
#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "shared/host/file.h"
#include "tests/support/carried_over.h"
#include "tests/support/outlook_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/policy/rl/train.h"

namespace bess::outlook_residual {
namespace {

TrainOptions small_options() {
  TrainOptions options;
  options.context = ContextKind::kOutlook;
  options.batch_size = 96;
  options.atoms = 21;
  options.steps = 60;
  options.validate_every = 60;
  options.threads = 1;
  return options;
}

/// Requests a stop after this number of checks.
std::function<bool()> after(long looks) {
  return [looks]() mutable { return looks-- <= 0; };
}

const OutlookMarket& prices() {
  static const OutlookMarket drawn = outlook_market({2025, 3, 1}, 27);
  return drawn;
}
const MarketSteps& market() {
  static const MarketSteps steps = prices().steps();
  return steps;
}
const TrainResult& learnt() {
  static const TrainResult result = train_teacher(market(), {}, small_options(), after(1000));
  return result;
}
/// As before the first step, except that the last layer's weights are a multiple of drawn ones.
Teacher beginner(float share = 0) {
  Teacher teacher = learnt().teacher;
  const Parameters drawn = initial_parameters(teacher.shape, 7);
  teacher.parameters = drawn;
  begin_at_zero(teacher.method, teacher.support, teacher.shape, teacher.parameters);
  MutableMlp(teacher.shape, teacher.parameters.data()).w3 +=
      share * ConstMlp(teacher.shape, drawn.data()).w3;
  return teacher;
}
/// It changes some of the program's decisions.
Teacher opinionated() { return beginner(3); }

/// Training states of students from two training days.
Matrix taught(const Teacher& teacher) {
  MarketSteps two = market();
  two.days.resize(2);
  return visited_inputs(teacher, two, {}, {});
}

std::vector<Action> decisions(const Teacher& teacher, const MarketSteps& shown) {
  TeacherPolicy policy(teacher);
  const std::vector<MarketDay> days(shown.days.begin() + 20, shown.days.begin() + 22);
  return actions_before(shown, days, policy, INT64_MAX);
}

TEST(OutlookResidual, BeforeTheFirstStepItDecidesAndTeachesAsTheProgram) {
  const Teacher teacher = beginner();
  Teacher program = teacher;
  program.method = Method::kSdp;
  expect_same_decisions(TeacherPolicy(teacher), OutlookPolicy(teacher.outlook),
                        std::span(market().steps).subspan(9 * 720, 2 * 720));
  EXPECT_EQ(taught(teacher), taught(program));
}

TEST(OutlookResidual, WhatItAddsDecidesAndIsTaught) {
  const Teacher other = opinionated();
  Teacher program = other;
  program.method = Method::kSdp;
  EXPECT_NE(decisions(other, market()), decisions(program, market()));
  EXPECT_NE(taught(other), taught(program));
}

TEST(OutlookResidual, IsRewardedAndTaughtTheSameOnAnyNumberOfThreads) {
  const Teacher& teacher = learnt().teacher;
  const auto on = [&](int threads) {
    return TrainingMarket(market(), teacher.price_map, {}, Horizon::kContinuing,
                          {.program = teacher.base_programs(), .threads = threads},
                          teacher.context);
  };
  const TrainingMarket alone = on(1), together = on(3);
  for (std::size_t i = 0; i < alone.step_count(); i += 7) {
    Transition a{}, b{};
    (void)alone.make_transition(i, 0.37, Action::kCharge, a);
    (void)together.make_transition(i, 0.37, Action::kCharge, b);
    ASSERT_EQ(a.reward, b.reward) << i;
    ASSERT_EQ(a.state[2], b.state[2]) << i;
  }
  MarketSteps three = market();
  three.days.resize(3);
  DistilOptions options;
  options.threads = 1;
  const Matrix taught_alone = visited_inputs(teacher, three, {}, options);
  options.threads = 3;
  EXPECT_EQ(taught_alone, visited_inputs(teacher, three, {}, options));
}

TEST(OutlookResidual, RewardIsTheProgramsErrorInOneStepLessTheCommonPart) {
  const Teacher& teacher = learnt().teacher;
  const OutlookProgram& program = *teacher.outlook;
  const TrainingMarket shaped(market(), teacher.price_map, {}, Horizon::kContinuing,
                              {.program = teacher.base_programs()}, teacher.context);
  const TrainingMarket plain(market(), teacher.price_map, {}, Horizon::kContinuing, {});
  const double unit = learned_per_eur({});
  const MarketStep* step = market().of(market().days_of(Split::kTrain)[0]).data();
  OutlookProgram::Plan plan;
  int new_plans = 0;
  double largest = 0;
  for (std::size_t i = 0; i + 1 < 1000; ++i) {
    if (!plan.serves(step[i])) plan = program.plan_of(step[i]);
    const bool renews = !plan.serves(step[i + 1]);
    new_plans += renews;
    if (i % 23 != 0 && !renews) continue;
    OutlookProgram::Plan next_plan = renews ? program.plan_of(step[i + 1]) : plan;
    std::optional<double> centre;  // the baseline that is subtracted
    for (const double soc : {0.1, 0.4321, 1.0}) {
      const auto here = program.action_values(step[i], soc, plan);
      for (int a = 0; a < kActionCount; ++a) {
        Transition t{}, paid{};
        const double next_soc = shaped.make_transition(i, soc, static_cast<Action>(a), t);
        (void)plain.make_transition(i, soc, static_cast<Action>(a), paid);
        const auto next = program.action_values(step[i + 1], next_soc, next_plan);
        const double best = *std::ranges::max_element(next);
        for (int b = 0; b < kActionCount; ++b) {
          EXPECT_NEAR(t.next_advantage[b], (next[b] - best) * unit, 2e-3);
        }
        const double error = double{paid.reward} + (program.gamma() * best - here[a]) * unit;
        if (!centre) centre = error - double{t.reward};
        EXPECT_NEAR(error - double{t.reward}, *centre, 2e-3) << i << ' ' << soc << ' ' << a;
        largest = std::max(largest, std::abs(double{t.reward}));
      }
    }
  }
  EXPECT_EQ(new_plans, 2);  // at publication and at midnight
  EXPECT_LT(largest, 1) << "a plan's values are worth thousands of euros";
}

TEST(OutlookResidual, LearnsFromTheInputsThatItDecidesBy) {
  const Teacher& teacher = learnt().teacher;
  const TrainingMarket training(market(), teacher.price_map, {}, Horizon::kContinuing,
                                {.program = teacher.base_programs()}, teacher.context);
  const auto steps = market().of(market().days_of(Split::kTrain)[0]);
  float x[kNetworkInputs];
  for (std::size_t i = 0; i < 700; i += 13) {
    Transition t{};
    const double next_soc = training.make_transition(i, 0.37, Action::kCharge, t);
    teacher.write_inputs(steps[i], 0.37, x);
    for (int n = 0; n < kNetworkInputs; ++n) EXPECT_NEAR(t.state[n], x[n], 1e-3) << i << ' ' << n;
    teacher.write_inputs(steps[i + 1], next_soc, x);
    for (int n = 0; n < kNetworkInputs; ++n) EXPECT_NEAR(t.next_state[n], x[n], 1e-3) << i;
  }
}

TEST(OutlookResidual, FollowsTheProgramInTheCurveAndIsNeverWorse) {
  ASSERT_EQ(learnt().curve.size(), 2U);
  EXPECT_EQ(learnt().curve[0].step, 0);
  OutlookPolicy program(learnt().teacher.outlook);
  const double alone =
      evaluate(market(), market().days_of(Split::kValidation), program, kCarriedOver)
          .profit_eur_per_day_per_mwh();
  EXPECT_EQ(learnt().curve[0].validation_eur_per_day_per_mwh, alone);
  EXPECT_GE(learnt().best_validation_eur_per_day_per_mwh, alone);
  for (const CurvePoint& point : learnt().curve) EXPECT_LT(point.edge_mass_frac, 5e-3);
}

TEST(OutlookResidual, ResumedItGivesTheSameFileToTheByte) {
  const TemporaryFolder folder;
  const TrainOptions options = small_options();
  const CheckpointOptions first{folder.file("a.checkpoint"), false, "this run"};
  const TrainResult part = train_teacher(market(), {}, options, after(40), first);
  ASSERT_EQ(part.curve.size(), 1U);  // between the steps
  const TrainResult resumed =
      train_teacher(market(), {}, options, after(1000), {first.path, true, "this run"});
  save_teacher(folder.file("whole.bin"), learnt().teacher);
  save_teacher(folder.file("resumed.bin"), resumed.teacher);
  EXPECT_EQ(read_file(folder.file("resumed.bin")), read_file(folder.file("whole.bin")));
  EXPECT_EQ(resumed.curve.back().loss, learnt().curve.back().loss);
}

// Days after the last one used for training or validation: reversing them changes no byte.
TEST(OutlookResidual, LearnsNothingFromLaterDays) {
  MinuteSeries moved = prices().minutes;
  DayAheadSeries turned = prices().day_ahead;
  const std::int64_t from = local_midnight_utc_s({2025, 3, 26});
  for (std::size_t m = 0; m < moved.size(); ++m) {
    if (moved.utc_s(m) >= from) moved.indicative[m] = 500 - moved.indicative[m];
    if (moved.utc_s(m) >= from) moved.settled[m] = 500 - moved.settled[m];
  }
  for (std::size_t q = 0; q < turned.size(); ++q) {  // those of the 27th come on the 26th
    if (turned.utc_s(q) >= local_midnight_utc_s({2025, 3, 27})) turned.eur_per_mwh[q] = 7;
  }
  MarketSteps other = make_market_steps(moved, {});
  attach_day_ahead(other, std::make_shared<DayAheadPublication>(turned));
  const TrainResult result = train_teacher(other, {}, small_options(), after(1000));
  EXPECT_EQ(result.teacher.parameters, learnt().teacher.parameters);
  EXPECT_EQ(result.curve.back().loss, learnt().curve.back().loss);
}

TEST(OutlookResidual, ItsFileIsReadBackAndOneOfAnOlderVersionIsNone) {
  const TemporaryFolder folder;
  const auto path = folder.file("teacher.bin");
  const Teacher teacher = opinionated();
  save_teacher(path, teacher);
  std::string bytes = read_file(path);
  const Teacher read = load_teacher(path);
  ASSERT_TRUE(read.is_residual());
  EXPECT_EQ(read.parameters, teacher.parameters);
  EXPECT_EQ(decisions(read, market()), decisions(teacher, market()));
  save_teacher(path, read);
  EXPECT_EQ(read_file(path), bytes);
  EXPECT_EQ(bytes[8], 4);
  Teacher alone = teacher;  // an older bess-train also reads one of the program alone
  alone.method = Method::kSdp;
  alone.shape = {};
  alone.parameters = {};
  save_teacher(path, alone);
  EXPECT_EQ(read_file(path)[8], 3);
  bytes[8] = 3;
  write_file(path, resealed(bytes));
  EXPECT_NE(refusal_of([&] { (void)load_teacher(path); }), "");
}

}  // namespace
}  // namespace bess::outlook_residual
