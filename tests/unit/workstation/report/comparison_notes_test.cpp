#include "tests/support/tokens.h"
#include "workstation/report/report_tables.h"

#include <gmock/gmock.h>

namespace bess {
namespace {

NamedEvaluation earning(const std::string& name, double eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 8;
  evaluation.days = {{"2023-01-26", eur, 0, 0, 0}, {"2023-01-27", -eur / 2, 0, 0, 0}};
  return {name, evaluation, evaluation};
}

TEST(ComparisonNotes, TheWholeBatteryIsCapacityTimesWhatAMwhEarns) {
  const std::vector<NamedEvaluation> evaluations{earning("rbc", -80),
                                                 earning("corrected student", 4000)};
  EXPECT_THAT(whole_battery_text(evaluations), Names("8 MWh 1000.0 EUR power_w capacity_wh"));
  std::vector<NamedEvaluation> house{earning("corrected student", 4)};
  house[0].day_reset.capacity_mwh = house[0].carried_over.capacity_mwh = 0.008;
  EXPECT_THAT(whole_battery_text(house), Names("8 kWh 1.00 EUR"));
  const std::string html = whole_battery_html(evaluations);
  EXPECT_NE(html.find(">1000.0</td>"), std::string::npos) << html;
  EXPECT_NE(html.find(">\u221220.0</td>"), std::string::npos) << "a true minus";
  EXPECT_EQ(whole_battery_text({earning("rbc", 1)}), "");
  EXPECT_EQ(whole_battery_html({}), "");
}

TEST(ComparisonNotes, AProgramAndItsTeacherAreExplainedWhereTheyAreTheSame) {
  EXPECT_THAT(same_program_text({earning("sdp", 5), earning("sdp teacher", 5)}), Names("sdp"));
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("sdp teacher", 5.0000001)}), "");
  EXPECT_THAT(same_program_text({earning("sdp", 5), earning("c51 teacher", 5)}), Names("sdp c51"));
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("c51 teacher", 6)}), "");
  EXPECT_EQ(same_program_text({earning("sdp", 5), earning("plain student", 5)}), "");
}

}  // namespace
}  // namespace bess
