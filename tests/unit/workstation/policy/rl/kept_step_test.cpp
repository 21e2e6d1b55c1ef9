#include "workstation/policy/rl/train.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "workstation/base/random.h"

namespace bess {
namespace {

/// Days 21 to 25 of five months, which bring so much each, of a battery of 1 MWh.
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
  EXPECT_NEAR(gain_at_least({1, 3}, 2), 2 - 25.452, 1e-3);      // half of the 5 % for each look
  EXPECT_NEAR(gain_at_least({2, 2, 2, 2, 2, 2}, 6), 2, 1e-12);  // every day the same
  const double mixed = gain_at_least({1, 3, 1, 3, 2, 3, 1, 3, 1, 2}, 6);
  const double by_month =
      gain_at_least({1, 1, 1, 1, 2, 3, 3, 3, 3, 2}, 6);  // the same days, sorted
  EXPECT_GT(mixed, 0);
  EXPECT_LT(by_month, 0) << "two months that differ are two witnesses, not ten";
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

/// A training that gains nothing: noise of the days, and of the month, drawn anew and added up from
/// look to look as weights that wander do.
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
