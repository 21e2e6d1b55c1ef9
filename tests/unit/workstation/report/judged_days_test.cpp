// Days of a figure, and the training's use of later ones.
#include "workstation/report/evaluation_days.h"

#include <gmock/gmock.h>

#include "tests/support/tokens.h"
#include "tests/unit/workstation/report/report_test_support.h"

namespace bess {
namespace {

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
