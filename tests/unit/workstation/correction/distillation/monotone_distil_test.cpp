// Monotone distillation: within the bounds the integer student is monotone for any weights, without
// them not. It learns from its teacher, obeys the thresholds, and repeats bit-identically.
#include "workstation/correction/distillation/monotone_distil.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/carried_over.h"
#include "tests/support/rule_sets.h"
#include "tests/support/small_market.h"
#include "tests/support/student_nets.h"
#include "tests/support/teachers.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/correct_and_prove.h"
#include "workstation/correction/student/student_policy.h"

namespace bess {
namespace {

const std::atomic<bool> kRunning{false};

struct School {
  MarketSteps market = make_market_steps(small_series(), {});
  Teacher teacher;
  DistilOptions options;
  Matrix visited;
  TrainingBatch batch;

  School() : teacher(make_teacher()) {
    options.epochs = 12;
    options.seed = 5;
    visited = visited_inputs(teacher, market, {}, options);
    batch = make_training_states(teacher, visited, options);
  }
  [[nodiscard]] Teacher make_teacher() const {
    std::vector<double> prices;
    for (const MarketStep& step : market.steps) prices.push_back(step.observed_eur_per_mwh);
    return program_teacher(market, PriceMap::fit(prices), program_of(market));
  }
};

const School& school() {
  static const School school;
  return school;
}

TEST(TrainingBatch, HasTheTeachersActionAndTheLossOfOthers) {
  const TrainingBatch& batch = school().batch;
  ASSERT_EQ(batch.inputs.cols(), batch.teacher_frac.cols());
  ASSERT_GT(batch.inputs.cols(), school().visited.cols());
  MlpTile tile;
  for (Eigen::Index c = 0; c < batch.inputs.cols(); c += 997) {
    const Matrix values = school().teacher.action_values(batch.inputs.middleCols(c, 1), tile);
    const auto best = static_cast<int>(argmax_action(values.data()));
    EXPECT_EQ(batch.regret(best, c), 0);
    EXPECT_NEAR(batch.teacher_frac.col(c).sum(), 1, 1e-5);
    EXPECT_EQ(batch.teacher_frac.col(c).maxCoeff(), batch.teacher_frac(best, c));
    EXPECT_GE(batch.inputs.col(c).minCoeff(), 0);
    EXPECT_LE(batch.inputs.col(c).maxCoeff(), 1);
  }
}

/// States in which the teacher's first choice violates the rules.
int broken_training_states(const Teacher& teacher, const RuleSet& rules,
                           const DistilOptions& options) {
  const RuleSamples samples(rules, teacher.context.kind);
  const TrainingBatch batch = make_training_states(teacher, school().visited, options);
  int broken = 0;
  for (Eigen::Index c = 0; c < batch.inputs.cols(); ++c) {
    const ActionSet left = samples.actions_at(batch.inputs.col(c).data(), teacher.price_map);
    Eigen::Index first = 0;
    batch.teacher_frac.col(c).maxCoeff(&first);
    broken += allows(left, static_cast<Action>(first)) ? 0 : 1;
  }
  return broken;
}

TEST(TrainingBatch, ObeysTheRulesForAnyTeacher) {
  const RuleSet rules = load_rules({example_rule_path("quiet_hours")});
  for (const Method method : {Method::kSdp, Method::kC51, Method::kDqn}) {
    SCOPED_TRACE(method_name(method));
    Teacher teacher = school().teacher;
    if (method != Method::kSdp) {
      const Support support{.v_min = -15, .v_max = 15, .count = 51};
      const MlpShape shape = teacher_shape(method, support);
      teacher.method = method;
      teacher.support = support;
      teacher.shape = shape;
      teacher.parameters = initial_parameters(shape, 1);
      teacher.program = nullptr;
    }
    DistilOptions options = school().options;
    EXPECT_GT(broken_training_states(teacher, rules, options), 1000)
        << "the teacher ignores the rules";
    options.rules = rules;
    EXPECT_EQ(broken_training_states(teacher, rules, options), 0);
  }
}

TEST(MonotoneDistiller, RegretFallsAndTheBoundsHold) {
  MonotoneDistiller distiller(school().teacher, school().batch, school().options);
  const SignBounds bounds = SignBounds::monotone();
  distiller.run(12, {}, kRunning,
                [&](double) { EXPECT_TRUE(bounds.contain(distiller.parameters())); });
  const auto& curve = distiller.curve();
  ASSERT_EQ(curve.size(), 12U);
  EXPECT_LT(curve.back().visited_loss, 0.5 * curve.front().visited_loss);
}

TEST(MonotoneDistiller, SameSeedAndThreadsGiveTheSameBits) {
  for (const int threads : {1, 2}) {
    DistilOptions options = school().options;
    options.threads = threads;
    Parameters results[2];
    for (Parameters& result : results) {
      MonotoneDistiller distiller(school().teacher, school().batch, options);
      distiller.run(2, {}, kRunning, [](double) {});
      result = distiller.parameters();
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_TRUE(results[0].allFinite());
  }
}

TEST(MonotoneDistiller, InterruptionReturns) {
  MonotoneDistiller distiller(school().teacher, school().batch, school().options);
  const std::atomic<bool> interrupted{true};
  int looks = 0;
  distiller.run(1'000'000, {}, interrupted, [&](double) { ++looks; });
  EXPECT_EQ(looks, 0);
  EXPECT_TRUE(distiller.curve().empty());
}

/// Remaining rule violations of a student that is trained with them briefly.
std::vector<DemandCount> counts_with_rules(const std::vector<const char*>& rules) {
  DistilOptions options = school().options;
  options.epochs = 60;
  options.repair_epochs = 30;
  options.repair_rounds = 3;
  int n = 0;
  for (const char* lines : rules) {
    options.rules.rules.push_back(one_rule(lines, "rule " + std::to_string(++n)).rules[0]);
  }
  options.correction.thresholds = options.rules.thresholds(options.correction.thresholds);
  const CorrectionResult result =
      correct_and_prove(school().teacher, school().visited, options, kRunning);
  const std::vector<DemandCount> counts = demand_counts(student_of(result.verdict).certificate);
  EXPECT_TRUE(std::holds_alternative<ProvedStudent>(result.verdict))
      << round_of(student_of(result.verdict).certificate).text();
  EXPECT_EQ(counts.size(), kPropertyCount + rules.size());
  for (const DemandCount& count : counts) {
    EXPECT_EQ(count.states > 0, count.binds_student) << count.text;
  }
  return counts;
}

// Every kind of rule that the README documents.

TEST(CorrectAndProve, DemandsOnStatesAreLearntAndProved) {
  const auto counts = counts_with_rules(
      {"is = \"idle\"\nprice_min = 80\nprice_max = 100\nhours = \"01:00-05:00\"",
       "is_not = \"charge\"\nprice_min = 300",
       "is_not = \"discharge\"\nprice_max = 20\nsoc_max = 0.5",
       "at_least = \"idle\"\nhours = \"17:00-20:00\"\nsoc_max = 0.3\nprice_max = 600",
       "at_most = \"idle\"\nprice_min = 400\ncontext_classes = [11, 12]",
       "charge_at_or_below = -200", "discharge_at_or_above = 900",
       "power_max = 0.5\nhours = \"18:00-21:00\"\nenforce = true"});
  EXPECT_FALSE(counts.back().binds_student) << "a power rule only binds the guard";
}

TEST(CorrectAndProve, DirectionsAreLearntAndProved) {
  counts_with_rules({"never_rises_with = \"minute\"", "never_falls_with = \"context_class\"",
                     "never_falls_with = \"quarter_hour\"", "never_rises_with = \"soc\""});
}

TEST(CorrectAndProve, ToChargeOrDischargeWithoutARestIsLearntAndProved) {
  counts_with_rules({"is_not = \"idle\"\nhours = \"17:00-20:00\""});
}

/// Thresholds inside the market's prices, where the teacher would often act differently.
TEST(CorrectAndProve, ByConstructionTheThresholdsAreLearntAndTheStudentEarns) {
  DistilOptions options = school().options;
  options.epochs = 60;
  options.repair_epochs = 30;
  options.correction.thresholds = {-20, 260};
  const CorrectionResult result =
      correct_and_prove(school().teacher, school().visited, options, kRunning,
                        validation_score(school().market, {}, 0.5));
  ASSERT_TRUE(std::holds_alternative<ProvedStudent>(result.verdict));
  EXPECT_LE(result.rounds.size(), 3U);
  const StudentFile& file = student_of(result.verdict);
  const StudentNet& net = file.net;
  EXPECT_EQ(net.context, school().teacher.context);
  const auto chosen =
      std::ranges::find(result.checkpoints, CheckpointState::kChosen, &StudentCheckpoint::state);
  ASSERT_NE(chosen, result.checkpoints.end());
  EXPECT_EQ(chosen->validation_eur_per_day_per_mwh,
            validation_score(school().market, {}, 0.5)(file).profit);
  for (const StudentCheckpoint& other : result.checkpoints) {
    if (other.round != chosen->round) {
      EXPECT_EQ(other.state, CheckpointState::kDisobeys);
    }
    if (other.state == CheckpointState::kPassedOver) {
      EXPECT_LE(other.validation_eur_per_day_per_mwh, chosen->validation_eur_per_day_per_mwh);
    }
  }
  Random random(3);
  for (int i = 0; i < 5'000; ++i) {
    LatticeState s = random_state(random);
    s.price_eur_per_mwh = static_cast<std::int16_t>(-500 + static_cast<int>(random.index(481)));
    EXPECT_EQ(net.decide(s), Action::kCharge);
    s.price_eur_per_mwh = static_cast<std::int16_t>(260 + static_cast<int>(random.index(1'241)));
    EXPECT_EQ(net.decide(s), Action::kDischarge);
  }
  StudentPolicy student(net);
  RuleBasedPolicy rule(kPaperRuleLowEurPerMwh, kPaperRuleHighEurPerMwh);
  const auto days = school().market.days_of(Split::kTest);
  EXPECT_GT(evaluate(school().market, days, student, kCarriedOver).profit_eur_per_day_per_mwh(),
            evaluate(school().market, days, rule, kCarriedOver).profit_eur_per_day_per_mwh());
}

/// Contexts with a pair of neighbours at which the action rises with price or SoC.
int rising_contexts(const StudentNet& net, std::uint64_t seed) {
  constexpr int kContexts = 4;
  Random random(seed);
  int rising = 0;
  std::vector<std::int8_t> grid;
  for (int c = 0; c < kContexts; ++c) {
    const LatticeState s = random_state(random);
    fill_action_grid(net, s, true, grid);
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
  EXPECT_GT(with_all_actions, 0) << "a constant action would prove nothing";
}

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
