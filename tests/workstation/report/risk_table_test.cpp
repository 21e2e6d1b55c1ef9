#include "workstation/report/risk_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bess {
namespace {

using testing::HasSubstr;

/// Days that earn first, first + 1, ... EUR per MWh of 2 MWh.
Evaluation days_from(int first, int count) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 2;
  for (int d = count; d-- > 0;) {  // the order of the days is not that of their profits
    evaluation.days.push_back({"2023-01-01", 2.0 * (first + d), 1.5, 10, 0.5});
  }
  return evaluation;
}

TEST(RiskTable, ABadDayIsTheTwentiethFromBelow) {
  EXPECT_EQ(bad_day_eur_per_mwh(days_from(7, 1)), 7);
  EXPECT_EQ(bad_day_eur_per_mwh(days_from(7, 20)), 7);
  EXPECT_EQ(bad_day_eur_per_mwh(days_from(7, 21)), 8);
  EXPECT_EQ(bad_day_eur_per_mwh(days_from(7, 100)), 11);
}

TEST(RiskTable, ShowsTheTeacherAndItsCautiousTwins) {
  const std::string name = "c51 teacher";
  std::vector<NamedEvaluation> all{{"rbc", {}, days_from(0, 42)}, {name, {}, days_from(10, 42)}};
  EXPECT_EQ(risk_table(all, name), "") << "there is nothing to compare";
  all.push_back({risk_name(name, 0.1), {}, days_from(-30, 42)});
  const std::string table = risk_table(all, name);
  EXPECT_THAT(table, HasSubstr("what the c51 teacher chooses by"));
  EXPECT_THAT(table, HasSubstr("mean          30.5      12.0       10.0    1.50\n"));
  EXPECT_THAT(table, HasSubstr("cvar:0.1      -9.5     -28.0      -30.0    1.50\n"));
  EXPECT_EQ(table.find("cvar:0.25"), std::string::npos);
  EXPECT_EQ(table.find("rbc"), std::string::npos);
  EXPECT_EQ(risk_table({}, name), "");

  const std::string html = risk_choice_html(all, name);
  EXPECT_THAT(html, HasSubstr("What the c51 teacher chooses by"));
  EXPECT_THAT(html, HasSubstr(R"(<th scope="row">mean</th><td data-label="Profit">30.5</td>)"
                              R"(<td data-label="5 % day">12.0</td>)"
                              R"(<td data-label="Worst day">10.0</td>)"));
  EXPECT_THAT(html, HasSubstr("cvar:0.1</th>"));
  EXPECT_EQ(html.find("cvar:0.25</th>"), std::string::npos);
  all.pop_back();
  EXPECT_EQ(risk_choice_html(all, name), "");
}

}  // namespace
}  // namespace bess
