#include "workstation/report/headline.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/report/backtest_report.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

using testing::AllOf;
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

// Backtest report: the number of fitting days of each month, and the untraded months.

/// Two months of three days; each policy earns this amount on its second day, and 10 EUR on every
/// other one.
WalkForward traded(const std::string& name, double second_day_eur) {
  WalkForward result{.name = name};
  for (const std::string month : {"2023-04", "2023-05"}) {
    Evaluation e;
    e.capacity_mwh = 1;
    for (int day = 1; day <= 3; ++day) {
      e.days.push_back(
          {month + "-0" + std::to_string(day), day == 2 ? second_day_eur : 10, 1, 1, 0.5});
    }
    result.total.capacity_mwh = 1;
    result.total.days.insert(result.total.days.end(), e.days.begin(), e.days.end());
    result.by_month.push_back(e);
  }
  return result;
}

BacktestResults results(double second_day_eur) {
  return {{traded("rbc", second_day_eur), traded("sdp", 40)},
          {{"2023-04", 90}, {"2023-05", 120}},
          {{"2023-02", "31 of the 120 days before it are there"}},
          120,
          "made by hand"};
}

TEST(BacktestReport, ShowsTheFittingDaysOfEachMonth) {
  BacktestResults fitted = results(5);
  EXPECT_THAT(format_backtest_table(fitted), Names("90 120"));
  EXPECT_THAT(backtest_csv(fitted),
              AllOf(HasSubstr(",fitted_days,"), HasSubstr(",90,"), HasSubstr(",120,")));
  EXPECT_THAT(backtest_json(fitted).line(),
              AllOf(HasSubstr("{\"month\":\"2023-04\",\"fitted_days\":90,"),
                    HasSubstr("\"not_traded\":[{\"month\":\"2023-02\",\"reason\":\"31 ")));
  for (BacktestMonth& month : fitted.months) month.fitted_days = 120;
  EXPECT_THAT(format_backtest_table(fitted), AllOf(Names("120"), testing::Not(Names("90"))));
}

/// April earned 10 a day more than the first, May 20: with two months the error is 5, regardless of
/// the days.
TEST(BacktestReport, ShowsErrorsByMonthNextToThePlainOnes) {
  BacktestResults fitted = results(10);
  WalkForward& sdp = fitted.policies[1];
  for (std::size_t d = 0; d < 6; ++d) {
    const double profit_eur = 10 + (d < 3 ? 10 : 20);
    sdp.total.days[d].profit_eur = profit_eur;
    sdp.by_month[d / 3].days[d % 3].profit_eur = profit_eur;
  }
  EXPECT_THAT(format_backtest_table(fitted), Names("+15.0 2.2 5.0 2 71 %"));
  EXPECT_THAT(backtest_csv(fitted), HasSubstr("all,sdp,6,25.0000,15.0000,2.2361,"));
  EXPECT_THAT(backtest_csv(fitted), HasSubstr(",,2.2361,5.0000,5.0000,1.0000\n"));
  EXPECT_THAT(backtest_json(fitted).line(), HasSubstr("\"gain_standard_error_by_month\":5.0000"));
  const TemporaryFolder folder;
  write_backtest_page(fitted, folder.file(""));
  EXPECT_THAT(read_file(folder.file("backtest.html")),
              HasSubstr("<td data-label=\"Gain by month\">5.0</td>"));
}

/// The second month is traded although the first is on the other side of a boundary.
TEST(BacktestReport, AFoldThatCrossesABoundaryOfTheMarketIsNamed) {
  const PriceRegime* const regimes = kPriceRegimes;
  BacktestResults crossing = results(5);
  for (WalkForward& policy : crossing.policies) {
    for (std::size_t d = 0; d < policy.total.days.size(); ++d) {
      policy.total.days[d].date = (d < 3 ? "2024-10-0" : "2024-12-0") + std::to_string(d % 3 + 1);
    }
  }
  crossing.months = {{"2024-10", 90, {{regimes + 1}, {regimes + 1}}},
                     {"2024-12", 120, {{regimes + 1}, {regimes + 2}}}};
  const auto is_named = Names(std::string("2024-12 ") + regimes[1].name + " " + regimes[2].name);
  EXPECT_THAT(format_backtest_table(crossing), is_named);
  EXPECT_THAT(backtest_json(crossing).line(),
              HasSubstr("\"fitted_days\":120,\"regimes_fitted\":[\"from 22 May 2024 (dead band and "
                        "floor, local mFRR)\"],\"regimes_traded\":[\"from 26 November 2024"));
  const TemporaryFolder folder;
  write_backtest_page(crossing, folder.file(""));
  EXPECT_THAT(read_file(folder.file("backtest.html")),
              AllOf(HasSubstr("\"marks\":[[3,\"PICASSO\"]]"), HasSubstr("<li>2024-12 "), is_named));
  write_backtest_page(results(5), folder.file(""));
  EXPECT_THAT(read_file(folder.file("backtest.html")), HasSubstr("\"marks\":[]"));
}

TEST(HeatMap, CellsWithinTheirErrorAreShadedAlike) {
  const HeatValue left{10, 1};
  EXPECT_EQ(shade_of({1.9, 1}, left).value, 0) << "within its error of zero";
  EXPECT_EQ(shade_of({30, NAN}, left).value, 0);
  EXPECT_EQ(shade_of({12, 1}, left).value, 10) << "within its error of the cell to the left";
  EXPECT_EQ(shade_of({13, 1}, left).value, 13);
}

TEST(BacktestReport, MarksAreWhereARegimeBeginsAmongTheDays) {
  EXPECT_EQ(regime_marks({"2024-11-24", "2024-11-27", "2025-10-01"}).line(),
            R"([[1,"PICASSO"],[2,"day-ahead in quarter-hours"]])");
  EXPECT_EQ(regime_marks({"2024-11-26", "2024-11-27"}).line(), "[]") << "it began before";
  EXPECT_EQ(regime_marks({}).line(), "[]");
}

}  // namespace
}  // namespace bess
