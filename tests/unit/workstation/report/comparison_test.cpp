#include "workstation/report/comparison.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tests/unit/workstation/report/report_test_support.h"
#include "workstation/report/figures/curves.h"
#include "workstation/report/figures/walk_forward_figure.h"

namespace bess {
namespace {

using testing::HasSubstr;

Evaluation evaluation_of(const std::vector<double>& profits_eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 8;
  for (const double profit : profits_eur) evaluation.days.push_back({"", profit, 1.5, 40, 0.5});
  return evaluation;
}

std::vector<NamedEvaluation> three_policies() {
  return {{"rule", evaluation_of({800, 1600, 2400}), evaluation_of({700, 1500, 2300})},
          {"student", evaluation_of({1600, 2400, 4000}), evaluation_of({1600, 2400, 4000})},
          {"foresight", evaluation_of({3200, 4000, 8800}), {}}};
}

TEST(Comparison, RowsAreThoseOfTheEvaluations) {
  const auto policies = three_policies();
  const auto rows = comparison_rows(policies, &NamedEvaluation::day_reset);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_DOUBLE_EQ(rows[0].profit, 200);
  EXPECT_FALSE(rows[0].difference.has_value());
  EXPECT_DOUBLE_EQ(rows[1].profit, policies[1].day_reset.profit_eur_per_day_per_mwh());
  EXPECT_DOUBLE_EQ(rows[1].errors.plain, policies[1].day_reset.errors().plain);
  const PairedDifference d = paired_difference(policies[1].day_reset, policies[0].day_reset);
  ASSERT_TRUE(rows[1].difference.has_value());
  EXPECT_DOUBLE_EQ(rows[1].difference->mean, d.mean);
  EXPECT_DOUBLE_EQ(rows[1].difference->errors.plain, d.errors.plain);
  EXPECT_DOUBLE_EQ(rows[1].worst_day, 200);
  ASSERT_TRUE(rows[1].foresight_share.has_value());
  EXPECT_NEAR(*rows[1].foresight_share, 0.5, 1e-12);
}

/// 8 MWh, days of 12 and 20 MWh through the battery: 16 MWh per day, 2 per MWh of capacity.
TEST(Comparison, ProfitAtTheReferenceWearByHand) {
  NamedEvaluation rule{"rule", evaluation_of({800, 1600}), {}};
  rule.day_reset.days[0].throughput_mwh = 12;
  rule.day_reset.days[1].throughput_mwh = 20;
  const auto at_reference = [&](double configured_wear) {
    rule.day_reset.wear_eur_per_mwh = configured_wear;
    return comparison_rows({rule}, &NamedEvaluation::day_reset).front().profit_at_reference_wear;
  };
  EXPECT_DOUBLE_EQ(at_reference(0), 150 - 10 * 2);
  EXPECT_DOUBLE_EQ(at_reference(10), 150);
  EXPECT_DOUBLE_EQ(at_reference(25), 150 + 15 * 2);  // instead of the 25, not added
  const std::string table = format_comparison_table({rule});
  EXPECT_THAT(table, HasSubstr("     180.0\n"));
  EXPECT_NE(comparison_csv({rule}).find("share_of_foresight,soc_end_frac_mean\nrule,2,"),
            std::string::npos);
  EXPECT_NE(comparison_csv({rule}).find(",180.0000,false,"), std::string::npos);
}

TEST(Comparison, WithoutForesightThereIsNoShare) {
  const auto rows = comparison_rows(three_policies(), &NamedEvaluation::carried_over);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_FALSE(rows[1].foresight_share.has_value());
}

TEST(Comparison, NothingToCompareIsNoTable) {
  EXPECT_EQ(format_comparison_table({}), "");
  EXPECT_EQ(format_comparison_table({{"empty", {}, {}}}), "");
}

TEST(Comparison, CsvHasOneLinePerPolicyAndWay) {
  const std::string csv = comparison_csv(three_policies());
  EXPECT_EQ(std::ranges::count(csv, '\n'), 6);
  EXPECT_THAT(csv, HasSubstr("\nrule,3,200.0000,,,100.0000,1.5000,40.0000,"));
  EXPECT_THAT(csv, HasSubstr("\nstudent,3,"));
}

/// Two days of January and two of February: the rule earns 0, the student 1 3 and 6 10 per MWh. By
/// hand (day_errors_test.cpp): mean 5, errors 1.958 and 3 by two months, known to within 71 %.
TEST(Comparison, BothErrorsAreNextToProfitAndGain) {
  NamedEvaluation rule{"rule", evaluation_of({0, 0, 0, 0}), {}};
  NamedEvaluation student{"student", evaluation_of({8, 24, 48, 80}), {}};
  const char* const dates[] = {"2023-01-30", "2023-01-31", "2023-02-27", "2023-02-28"};
  for (std::size_t d = 0; d < 4; ++d) {
    rule.day_reset.days[d].date = student.day_reset.days[d].date = dates[d];
  }
  const std::string table = format_comparison_table({rule, student});
  EXPECT_THAT(table, HasSubstr("   5.0   2.0       3.0  +5.0   2.0       3.0  "));
  EXPECT_THAT(table, HasSubstr("71 %"));
  const std::string csv = comparison_csv({rule, student});
  EXPECT_THAT(
      csv,
      HasSubstr(",profit_standard_error_by_month,gain_over,gain_standard_error_by_month,months,"));
  EXPECT_THAT(csv, HasSubstr(",3.0000,rule,3.0000,2,"));
}

TEST(Comparison, CsvQuotesNamesThatNeedIt) {
  const std::string csv = comparison_csv({{"student, \"new\"", evaluation_of({800}), {}}});
  EXPECT_THAT(csv, HasSubstr("\n\"student, \"\"new\"\"\",1,100.0000,"));
}

TEST(Curves, CsvAndSmoothing) {
  EXPECT_EQ(training_curve_csv({{250, 3.5, 400.25, 0.001, -2.5}}),
            "step,loss,validation_eur_per_day_per_mwh,validation_smoothed,edge_mass_frac,"
            "gain_at_least_eur_per_day_per_mwh\n"
            "250,3.5,400.2500,400.2500,0.001000,-2.5\n");
  EXPECT_EQ(distil_curve_csv({{1, 0.5, 0.25, 0.125}}),
            "epoch,teacher_loss,correction_loss,visited_loss\n1,0.5,0.25,0.125\n");
  EXPECT_EQ(centred_mean({0, 3, 6}, 1), (std::vector<double>{1.5, 3, 4.5}));
  EXPECT_TRUE(centred_mean({}, 2).empty());
}

TEST(Curves, ReadBackIsWhatWasWritten) {
  const std::string training = training_curve_csv({{0, 0, 400, 0}, {500, 3, -20, 0, -1e300}});
  EXPECT_EQ(training_curve_csv(parse_training_curve_csv(training, "a")), training);
  const std::string distil = distil_curve_csv({{1, 0.5, 1e-7, 0.125}, {2, 0.25, 0, 0.1}});
  EXPECT_EQ(distil_curve_csv(parse_distil_curve_csv(distil, "b")), distil);
}

TEST(Curves, DamagedFilesAreNamedWithTheLine) {
  const auto message_of = [](const std::string& text) {
    return refusal_of([&] { (void)parse_distil_curve_csv(text, "curve.csv"); });
  };
  const std::string header = distil_curve_csv({});
  EXPECT_NE(message_of("step\n").find("curve.csv:1:"), std::string::npos);
  EXPECT_NE(message_of(header + "1,2,3\n").find("curve.csv:2:"), std::string::npos);
  EXPECT_NE(message_of(header + "1,2,3,4\n1,2,x,4\n").find("curve.csv:3:"), std::string::npos);
}

/// Two days of these profits, 1 MWh.
Evaluation two_days(double first_eur, double second_eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 1;
  evaluation.days = {{"2023-01-21", first_eur, 1, 2, 0.5}, {"2023-01-22", second_eur, 1, 2, 0.5}};
  return evaluation;
}

OmegaPoint point(double omega, std::int64_t order_violations, double agreement,
                 const Evaluation& evaluation) {
  OmegaPoint p{omega, {}, 0.25, agreement, evaluation};
  p.certificate.states_checked = 1000;
  p.certificate.set_violations_of(3, order_violations);
  return p;
}

TEST(OmegaSweep, TableAndCsvCountTheSame) {
  const Evaluation teacher = two_days(90, 110);
  const std::vector<OmegaPoint> points{point(1e-6, 0, 0.75, two_days(80, 112)),
                                       point(1, 421, 0.875, two_days(95, 115))};
  EXPECT_EQ(omega_csv(points, teacher),
            "omega,states_checked,violations_property_1,violations_property_2,violations_property_"
            "3,divergence_nats,agreement,profit_eur_per_day_per_mwh,gain_standard_error,"
            "profit_standard_error,gain_eur_per_day_per_mwh,profit_"
            "standard_error_by_month,gain_standard_error_by_month\n"
            "1e-06,1000,0,0,0,0.25,0.750000,96.0000,6.0000,16.0000,-4.0000,,\n"
            "1,1000,0,0,421,0.25,0.875000,105.0000,0.0000,10.0000,5.0000,,\n");
  const std::string table = format_omega_table(points, teacher);
  EXPECT_THAT(table, Names("1000 421"));
  EXPECT_THAT(table, HasSubstr("    -4.0    6.0        -\n"));
  EXPECT_THAT(table, HasSubstr("87.50 %    105.0   10.0        -     +5.0    0.0        -\n"));
}

// Days of a figure, and the training's use of later ones.

/// January and February: February's test days are after all training, January's are not.
TEST(JudgedDays, SaysTheRuleTheSpanAndWhatLearningSaw) {
  const JudgedDays test = judged_days(small_market(), Split::kTest);
  EXPECT_THAT(judged_days_text(test), Names("26 9 2 2023-01-26 2023-02-28 2023-02-25 6"));
  EXPECT_EQ(judged_days_json(test).line(),
            "{\"split\":\"test\",\"local_days\":\"26 to the end\",\"days\":9,\"months\":2,"
            "\"from\":\"2023-01-26\",\"to\":\"2023-02-28\",\"last_learnt_day\":\"2023-02-25\","
            "\"days_before_last_learnt\":6}");
}

TEST(JudgedDays, DaysAfterAllLearningAreSaidToBe) {
  JudgedDays later = judged_days(small_market(), Split::kAll);
  later.last_learnt = "2022-12-25";
  EXPECT_THAT(judged_days_text(later), Names("1 59 2 2023-01-01 2023-02-28 2022-12-25"));
}

TEST(JudgedDays, TheTextIsThatOfTheSplit) {
  for (const auto& [split, first, last] :
       {std::tuple(Split::kTrain, 1, 20), std::tuple(Split::kValidation, 21, 25),
        std::tuple(Split::kTest, 26, 31), std::tuple(Split::kHeldOut, 21, 31)}) {
    int earliest = 99;
    int latest = 0;
    for (const MarketDay& day : small_market().days_of(split)) {
      earliest = std::min(earliest, day.day);
      latest = std::max(latest, day.day);
    }
    EXPECT_EQ(earliest, first);
    EXPECT_EQ(latest, last);
    EXPECT_THAT(judged_days_text(judged_days(small_market(), split)),
                Names(std::to_string(first) + (last == 31 ? "" : " " + std::to_string(last))));
  }
}

}  // namespace
}  // namespace bess
