#include "workstation/report/headline.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/support/tokens.h"
#include "workstation/data/env/evaluate.h"

namespace bess {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Excess of a day from the same charge over one in a chain.
constexpr double kGivenAwayEur = 5;

/// Days of 2 MWh of capacity that earned `profits_eur` and moved `throughput_mwh` each.
NamedEvaluation evaluated(const std::string& name, const std::vector<double>& profits_eur,
                          double throughput_mwh) {
  NamedEvaluation named{name, {}, {}};
  named.carried_over.capacity_mwh = 2;
  for (const double profit_eur : profits_eur) {
    DayResult day{"2023-01-26", profit_eur, 1, 10, 0.5};
    day.throughput_mwh = throughput_mwh;
    day.soc_start_frac = 0.5;
    named.carried_over.days.push_back(day);
  }
  named.day_reset = named.carried_over;
  for (DayResult& day : named.day_reset.days) day.profit_eur += kGivenAwayEur;
  return named;
}

std::vector<NamedEvaluation> all() {
  return {evaluated("rbc", {10, 20, 30}, 2), evaluated("rbc-tuned", {60, 80, 100}, 4),
          evaluated(kPlainName, {101, 119, 141}, 8), evaluated(kCorrectedName, {100, 120, 140}, 6),
          evaluated(kForesightName, {200, 240, 280}, 9)};
}

TEST(Headline, IsAboutTheCorrectedStudent) {
  const Headline headline = headline_of(all()).value();
  EXPECT_EQ(headline.days, 3u);
  EXPECT_DOUBLE_EQ(headline.profit, 60);
  EXPECT_DOUBLE_EQ(headline.foresight_share.value(), 0.5);
  ASSERT_EQ(headline.gains.size(), 3u);  // an unevaluated policy is left out
  EXPECT_EQ(headline.gains[0].against, kPlainName);
  EXPECT_EQ(headline.gains[1].against, "rbc-tuned");
  EXPECT_EQ(headline.gains[2].against, kForesightName);
}

TEST(Headline, IsCarriedOverAndNamesTheFriendlierAccounting) {
  std::vector<NamedEvaluation> evaluations = all();
  Headline headline = headline_of(evaluations).value();
  EXPECT_DOUBLE_EQ(headline.reset_profit.value(), 60 + kGivenAwayEur / 2);
  EXPECT_THAT(headline_text(headline),
              testing::AllOf(Names("60.0 EUR 62.5"), Not(Names("EUR/MWh"))));
  Evaluation& days = evaluations[3].carried_over;
  days.days.back().soc_start_frac = 0.25;  // a quarter of 2 MWh more at the end
  BatteryParameters battery;
  battery.capacity_wh = 2e6;
  value_charge_left(days, battery, 80);
  headline = headline_of(evaluations).value();
  EXPECT_DOUBLE_EQ(headline.profit, 60 + headline.charge_left.value_eur_per_day_per_mwh);
  EXPECT_NEAR(headline.charge_left.value_eur_per_day_per_mwh, 0.5 * std::sqrt(0.9) * 80 / 3 / 2,
              1e-9);
  EXPECT_THAT(headline_text(headline), Names("80.0 EUR/MWh +6.3"));
  EXPECT_THAT(headline_html(headline), Names("80.0 EUR/MWh"));
}

TEST(Headline, GainsArePairedAndCountWear) {
  const Headline headline = headline_of(all()).value();
  EXPECT_DOUBLE_EQ(headline.gains[1].difference[0].mean, 20);
  EXPECT_DOUBLE_EQ(headline.gains[1].difference[0].errors.plain, 0);  // 20 on each of the days
  EXPECT_DOUBLE_EQ(headline.gains[1].difference[1].mean, 10);         // 2 MWh per day more, at 10
  EXPECT_DOUBLE_EQ(headline.gains[0].difference[1].mean, headline.gains[0].difference[0].mean + 10);
}

TEST(Headline, WearReplacesTheConfiguredOne) {
  NamedEvaluation worn = evaluated("x", {100}, 4);
  worn.carried_over.wear_eur_per_mwh = 25;
  EXPECT_DOUBLE_EQ(at_wear(worn.carried_over, 25).days[0].profit_eur, 100);
  EXPECT_DOUBLE_EQ(at_wear(worn.carried_over, 0).days[0].profit_eur, 200);
  EXPECT_DOUBLE_EQ(at_wear(worn.carried_over, 10).days[0].profit_eur, 160);
  EXPECT_DOUBLE_EQ(at_wear(worn.carried_over, 10).profit_eur_per_day_per_mwh(),
                   worn.carried_over.profit_at_wear_eur_per_day_per_mwh(10));
}

TEST(Headline, ADifferenceIsClaimedBeyondItsIntervalOnly) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_shown({-2.1, 1, kUnknown, 1, 65}));
  EXPECT_FALSE(is_shown({1.9, 1, kUnknown, 1, 65}));
  EXPECT_FALSE(is_shown({100, kUnknown, kUnknown, 1, 1}));
  // Twelve months require 2.2 errors, four 3.2; months that agree by chance prove nothing more.
  EXPECT_TRUE(is_shown({2.3, 0.5, 1, 12, 65}));
  EXPECT_FALSE(is_shown({2.3, 0.5, 1, 4, 20}));
  EXPECT_FALSE(is_shown({1.9, 1, 0.1, 12, 65}));
}

/// A run with rules: their cost is not the correction's.
TEST(Headline, TheEffectIsSplitBetweenRulesAndCorrection) {
  std::vector<NamedEvaluation> dear = all();
  const std::string none = headline_html(headline_of(dear).value());
  dear[2] = evaluated(kPlainName, {110, 130.2, 149.8}, 8);
  const std::string html = headline_html(headline_of(dear).value());
  EXPECT_THAT(html, HasSubstr("id=\"effect-of-correction\""));
  EXPECT_THAT(html, Names("5.0"));
  dear[2] = evaluated(kPlainName, {300, 320.2, 339.8}, 8);
  dear.push_back(evaluated(under_rule_name("rest"), {110, 130.2, 149.8}, 8));
  dear.push_back(evaluated(kUnderAllRules, {110, 130.2, 149.8}, 8));
  EXPECT_THAT(headline_html(headline_of(dear).value()), Names("5.0 95.0"));
  EXPECT_THAT(none, Not(Names("95.0")));
}

TEST(Headline, WithoutACorrectedStudentThereIsNone) {
  EXPECT_FALSE(headline_of({evaluated("rbc", {1}, 1)}).has_value());
  NamedEvaluation reset_only = evaluated(kCorrectedName, {1}, 1);
  reset_only.carried_over = {};
  EXPECT_FALSE(headline_of({reset_only}).has_value());
}

TEST(Headline, OneDayHasNoError) {
  const Headline headline =
      headline_of({evaluated("rbc-tuned", {1}, 1), evaluated(kCorrectedName, {3}, 1)}).value();
  const std::string html = headline_html(headline);
  EXPECT_THAT(html, HasSubstr(">+1.0</span>"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

}  // namespace
}  // namespace bess
