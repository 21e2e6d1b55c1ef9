#include "workstation/policy/rl/train.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"
#include "workstation/base/random.h"

namespace bess {
namespace {

/// Forty days from the first of January 2023.
const MarketSteps& small_market() {
  static const MarketSteps market = simulated_market({2023, 1, 1}, 40);
  return market;
}

struct TrainCase {
  const char* name;
  Method method;
  Source source;
  Horizon horizon;
  long steps;
  bool residual = false;
};

void PrintTo(const TrainCase& c, std::ostream* out) { *out << c.name; }

TrainOptions small_options() {
  TrainOptions options;
  options.method = Method::kC51;
  options.residual = false;
  options.batch_size = 96;
  options.atoms = 21;
  options.validate_every = 100;
  options.steps = 200;
  return options;
}

TrainOptions options_of(const TrainCase& c) {
  TrainOptions options = small_options();
  options.method = c.method;
  options.source = c.source;
  options.horizon = c.horizon;
  options.steps = c.steps;
  options.residual = c.residual;
  return options;
}

TrainResult train(const TrainOptions& options) {
  const auto interrupted = [] { return false; };
  return train_teacher(small_market(), {}, options, interrupted);
}

/// Interruption query of a run: true after this number of checks, each before a step or before a
/// day of a validation.
auto interrupted_after(long looks) {
  return [asked = 0L, looks]() mutable { return asked++ >= looks; };
}

class TrainTeacher : public testing::TestWithParam<TrainCase> {};

TEST_P(TrainTeacher, RunsAndRepeatsBitIdentically) {
  const TrainOptions options = options_of(GetParam());
  const TrainResult result = train(options);
  const std::size_t points = static_cast<std::size_t>((options.steps + 99) / 100);
  ASSERT_EQ(result.curve.size(), points + (options.residual ? 1 : 0));  // the program is step 0
  for (const CurvePoint& point : result.curve) {
    EXPECT_TRUE(std::isfinite(point.loss));
    EXPECT_TRUE(std::isfinite(point.validation_eur_per_day_per_mwh));
    EXPECT_GE(point.edge_mass_frac, 0);
    EXPECT_LE(point.edge_mass_frac, 1);
    const double gain = options.residual ? point.validation_eur_per_day_per_mwh -
                                               result.curve[0].validation_eur_per_day_per_mwh
                                         : 0;
    EXPECT_LE(point.gain_at_least_eur_per_day_per_mwh, gain + 1e-9);
    EXPECT_GE(point.gain_at_least_eur_per_day_per_mwh, gain - 1'000) << "five days, in pairs";
  }
  EXPECT_EQ(result.curve.back().step, options.steps);
  const CurvePoint& kept = kept_point(result.curve);
  EXPECT_EQ(result.best_step, kept.step);
  EXPECT_EQ(result.best_validation_eur_per_day_per_mwh, kept.validation_eur_per_day_per_mwh);
  EXPECT_TRUE(result.teacher.parameters.allFinite());

  const TrainResult again = train(options);
  EXPECT_EQ(again.teacher.parameters, result.teacher.parameters);
  EXPECT_EQ(again.best_step, result.best_step);
  ASSERT_EQ(again.curve.size(), result.curve.size());
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    EXPECT_EQ(again.curve[i].loss, result.curve[i].loss);
    EXPECT_EQ(again.curve[i].validation_eur_per_day_per_mwh,
              result.curve[i].validation_eur_per_day_per_mwh);
  }
}

TEST_P(TrainTeacher, BestEarnsOnTheValidationDaysWhatIsReported) {
  const TrainResult result = train(options_of(GetParam()));
  TeacherPolicy policy(result.teacher);
  const auto days = small_market().days_of(Split::kValidation);
  EvaluationOptions evaluation;
  evaluation.carry_soc = true;
  EXPECT_DOUBLE_EQ(evaluate(small_market(), days, policy, evaluation).profit_eur_per_day_per_mwh(),
                   result.best_validation_eur_per_day_per_mwh);
}

TEST_P(TrainTeacher, ResumedItGivesTheSameWeightsToTheBit) {
  const TemporaryFolder folder;
  const TrainOptions options = options_of(GetParam());
  const TrainResult whole = train(options);
  const CheckpointOptions first{folder.file("a.checkpoint"), false, "this run"};
  const TrainResult broken_off =
      train_teacher(small_market(), {}, options, interrupted_after(options.steps / 2 + 7), first);
  ASSERT_LT(broken_off.curve.size(), whole.curve.size());  // between two validations
  const auto interrupted = [] { return false; };
  const CheckpointOptions second{first.path, true, "this run"};
  const TrainResult resumed = train_teacher(small_market(), {}, options, interrupted, second);
  EXPECT_EQ(resumed.teacher.parameters, whole.teacher.parameters);
  EXPECT_EQ(resumed.best_step, whole.best_step);
  ASSERT_EQ(resumed.curve.size(), whole.curve.size());
  for (std::size_t i = 0; i < whole.curve.size(); ++i) {
    EXPECT_EQ(resumed.curve[i].loss, whole.curve[i].loss);
    EXPECT_EQ(resumed.curve[i].gain_at_least_eur_per_day_per_mwh,
              whole.curve[i].gain_at_least_eur_per_day_per_mwh);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ways, TrainTeacher,
    testing::Values(
        TrainCase{"c51", Method::kC51, Source::kCounterfactual, Horizon::kContinuing, 300},
        TrainCase{"dqn_days", Method::kDqn, Source::kCounterfactual, Horizon::kDay, 150},
        TrainCase{"dqn_replay", Method::kDqn, Source::kReplay, Horizon::kContinuing, 40},
        TrainCase{"paper", Method::kC51, Source::kReplay, Horizon::kDay, 40},
        TrainCase{"residual", Method::kC51, Source::kCounterfactual, Horizon::kContinuing, 200,
                  true},
        TrainCase{"residual_dqn", Method::kDqn, Source::kReplay, Horizon::kContinuing, 40, true}),
    [](const auto& instance) { return instance.param.name; });

TEST(Train, LearnsToEarn) {
  TrainOptions options = small_options();
  options.batch_size = 384;
  options.validate_every = 500;
  options.steps = 500;
  const TrainResult result = train(options);
  EXPECT_GT(result.best_validation_eur_per_day_per_mwh, 0);
}

TEST(Train, InterruptedBeforeTheStartReturnsNothingValidated) {
  const auto interrupted = [] { return true; };
  const TrainResult result = train_teacher(small_market(), {}, small_options(), interrupted);
  EXPECT_TRUE(result.curve.empty());
  EXPECT_EQ(result.best_step, 0);
  EXPECT_TRUE(result.teacher.parameters.allFinite());
}

TEST(Train, InterruptedInTheMiddleKeepsTheBestSoFar) {
  TrainOptions options = small_options();
  options.steps = 1'000'000'000;
  options.validate_every = 10;
  const auto validation_days = static_cast<long>(small_market().days_of(Split::kValidation).size());
  const TrainResult result =
      train_teacher(small_market(), {}, options, interrupted_after(25 + 2 * validation_days));
  ASSERT_EQ(result.curve.size(), 2U);
  EXPECT_EQ(result.curve.back().step, 20);
  EXPECT_GT(result.best_step, 0);
}

TEST(Train, MissingDaysAreNamedWithTheRemedy) {
  const struct {
    const char* name;
    LocalDate first;
    int days;
    bool lacks_validation;  ///< local days 21 to 25, or else training days
  } cases[] = {{"validation only", {2023, 1, 21}, 4, false},
               {"training only", {2023, 1, 2}, 4, true},
               {"test only", {2023, 1, 27}, 3, true},
               {"validation and test", {2023, 1, 24}, 5, false}};
  const auto interrupted = [] { return false; };
  for (const auto& c : cases) {
    const MarketSteps market = simulated_market(c.first, c.days);
    const std::string message =
        refusal_of([&] { (void)train_teacher(market, {}, small_options(), interrupted); });
    EXPECT_NE(message, "") << c.name;
    EXPECT_EQ(has_code(message, "21"), c.lacks_validation) << c.name << ": " << message;
  }
}

TEST(Checkpoint, DamagedOrOfAnotherRunIsRefused) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a.checkpoint");
  const auto interrupted = [] { return false; };
  TrainOptions options = small_options();
  options.steps = 30;
  const auto refusal = [&](const std::string& identity) {
    return refusal_of([&] {
      (void)train_teacher(small_market(), {}, options, interrupted, {path, true, identity});
    });
  };
  EXPECT_THAT(refusal("this run"), Names(path));
  (void)train_teacher(small_market(), {}, options, interrupted, {path, false, "this run"});
  EXPECT_EQ(refusal("this run"), "");
  EXPECT_THAT(refusal("another run"), Names(path));
  const std::string sound = read_file(path);
  const auto expect_refused = [&](const std::string& bytes, const std::string& what) {
    write_file(path, bytes);
    EXPECT_THAT(refusal("this run"), Names(path)) << what;
  };
  Random random(93);
  for (int part = 0; part < 20; ++part) {
    expect_refused(sound.substr(0, sound.size() * static_cast<std::size_t>(part) / 20), "cut");
    std::string flipped = sound;
    flipped[random.index(flipped.size())] ^= 0x10;
    expect_refused(flipped, "flipped");
  }
  expect_refused(sound + "x", "appended");
}

/// Days 21 to 25 of five months with these earnings each, of a battery of 1 MWh.
Evaluation earned_on_validation_days(const std::vector<double>& eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 1;
  for (std::size_t d = 0; d < eur.size(); ++d) {
    const std::string date = fmt::format("2023-{:02}-{:02}", 1 + d / 5, 21 + d % 5);
    evaluation.days.push_back({date, eur[d], 0, 0, 0});
  }
  return evaluation;
}

double gain_at_least(const std::vector<double>& gains, long looks) {
  const std::vector<double> program(gains.size(), 0);
  return gain_at_least_eur_per_day_per_mwh(earned_on_validation_days(gains), program, looks);
}

TEST(KeptStep, TheLowerEndIsTheMeanLessStudentsTTimesTheWiderError) {
  EXPECT_NEAR(gain_at_least({1, 3}, 1), 2 - 12.706, 1e-3);      // one month: s.e. 1, t(1)
  EXPECT_NEAR(gain_at_least({1, 3}, 2), 2 - 25.452, 1e-3);      // half of the 5 % for each check
  EXPECT_NEAR(gain_at_least({2, 2, 2, 2, 2, 2}, 6), 2, 1e-12);  // every day the same
  const double mixed = gain_at_least({1, 3, 1, 3, 2, 3, 1, 3, 1, 2}, 6);
  const double by_month =
      gain_at_least({1, 1, 1, 1, 2, 3, 3, 3, 3, 2}, 6);  // the same days, sorted
  EXPECT_GT(mixed, 0);
  EXPECT_LT(by_month, 0) << "two months that differ are two samples, not ten";
  EXPECT_LT(gain_at_least({5}, 1), -1e9) << "one day shows nothing";
}

TEST(KeptStep, GainsAreOfTheSameDays) {
  const Evaluation earned = earned_on_validation_days({510, 12, -288, 101, 62});
  const std::vector<double> program{500, 0, -300, 90, 50};  // ahead by 10 to 12 on each
  EXPECT_NEAR(gain_at_least_eur_per_day_per_mwh(earned, program, 6), 11.4, 3);
}

TEST(KeptStep, OfThoseThatAreShownTheOneThatEarnedMost) {
  const struct {
    const char* name;
    std::vector<CurvePoint> curve;
    long kept;
  } cases[] = {
      {"a network alone", {{250, 1, 300, 0}, {500, 1, 320, 0}, {750, 1, 310, 0}}, 500},
      {"equals: the first", {{250, 1, 300, 0}, {500, 1, 300, 0}}, 250},
      {"luck", {{0, 0, 300, 0}, {250, 1, 340, 0, -0.1}, {500, 1, 330, 0, -20}}, 0},
      {"shown", {{0, 0, 300, 0}, {250, 1, 302, 0, 1.5}, {500, 1, 340, 0, -20}}, 250},
      {"two are shown", {{0, 0, 300, 0}, {250, 1, 302, 0, 1.5}, {500, 1, 303, 0, 0.5}}, 500},
      {"nothing changed", {{0, 0, 300, 0}, {250, 1, 300, 0, 0}}, 0},
      {"worse", {{0, 0, 300, 0}, {250, 1, 200, 0, -1e300}}, 0},
  };
  for (const auto& c : cases) EXPECT_EQ(kept_point(c.curve).step, c.kept) << c.name;
}

/// A training without gain: noise of the days, and of the month, redrawn and accumulated from check
/// to check like a random walk of the weights.
long kept_by_chance(Random& random) {
  constexpr long kLooks = 6;
  std::vector<CurvePoint> curve{{0, 0, 0, 0}};
  std::vector<double> gains(25, 0);
  for (long look = 1; look <= kLooks; ++look) {
    double month = 0;
    for (std::size_t d = 0; d < gains.size(); ++d) {
      if (d % 5 == 0) month = random.normal();
      gains[d] += month + 2 * random.normal();
    }
    const Evaluation earned = earned_on_validation_days(gains);
    curve.push_back(
        {look, 0, earned.profit_eur_per_day_per_mwh(), 0, gain_at_least(gains, kLooks)});
  }
  return kept_point(curve).step;
}

TEST(KeptStep, LuckIsKeptInOneOfTwentyAndAGainAlways) {
  Random random(42);
  int kept = 0;
  for (int training = 0; training < 1'000; ++training) kept += kept_by_chance(random) != 0 ? 1 : 0;
  fmt::print("of 1,000 trainings that gain nothing {} kept a step\n", kept);
  EXPECT_LE(kept, 50);
  std::vector<double> gains(25);
  for (double& gain : gains) gain = 10 + 2 * random.normal();
  EXPECT_GT(gain_at_least(gains, 6), 5);
}

}  // namespace
}  // namespace bess
