// Backtest report: the number of fitting days of each month, and the untraded months.
#include "workstation/report/backtest_report.h"

#include <gmock/gmock.h>

#include <cmath>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::HasSubstr;

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
