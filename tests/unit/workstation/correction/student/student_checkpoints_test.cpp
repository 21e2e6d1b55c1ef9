#include "workstation/correction/student/prove.h"

#include <gmock/gmock.h>

#include "shared/host/user_error.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(StudentCheckpoints, ReadBackWhatWasWritten) {
  const std::vector<StudentCheckpoint> written{{1, 300, 486.25, CheckpointState::kDisobeys},
                                               {1, 600, -3.5, CheckpointState::kPassedOver},
                                               {2, 640, 485, CheckpointState::kChosen}};
  const std::string text = student_checkpoints_csv(written);
  EXPECT_NE(text.find("1,300,486.2500,disobeys\n"), std::string::npos) << text;
  const auto read = parse_student_checkpoints_csv(text, "checkpoints.csv");
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].round, written[i].round);
    EXPECT_EQ(read[i].epoch, written[i].epoch);
    EXPECT_EQ(read[i].validation_eur_per_day_per_mwh, written[i].validation_eur_per_day_per_mwh);
    EXPECT_EQ(read[i].state, written[i].state);
  }
  EXPECT_TRUE(parse_student_checkpoints_csv(student_checkpoints_csv({}), "none.csv").empty());
}

TEST(StudentCheckpoints, AStrangeStateNamesFileAndLine) {
  EXPECT_THAT(
      [] {
        (void)parse_student_checkpoints_csv(
            "round,epoch,validation_eur_per_day_per_mwh,state\n1,2,3,taken\n", "checkpoints.csv");
      },
      testing::ThrowsMessage<UserError>(Names("checkpoints.csv:2 \"taken\"")));
}

}  // namespace
}  // namespace bess
