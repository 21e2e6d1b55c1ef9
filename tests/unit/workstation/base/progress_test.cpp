#include "workstation/base/progress.h"

#include <gmock/gmock.h>

namespace bess {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

TEST(ProgressLine, ShowsDoneRateAndTheRest) {
  EXPECT_EQ(
      progress_line("verify", "contexts", {.done = 120, .total = 420, .rate_per_s = 10}, "", 80),
      "verify: 120/420 contexts (10/s, ETA 30 s)");
  EXPECT_EQ(progress_line("verify", "contexts", {420, 420, 10, 42.4, true}, "", 80),
            "verify: 420/420 contexts (10/s, 42 s)");
  EXPECT_THAT(progress_line("train", "steps", {1, 8000, 0.5, 2}, "", 80),
              HasSubstr("ETA 4 h 26 min"));
  EXPECT_THAT(progress_line("train", "steps", {1, 2000, 1, 1}, "", 80), HasSubstr("ETA 33 min"));
  EXPECT_THAT(progress_line("train", "steps", {0, 8000, 0, 2}, "", 80), HasSubstr("ETA unknown"));
  EXPECT_THAT(progress_line("train", "steps", {0, 8000, 5853.2, 2}, "", 80), HasSubstr("(5853/s"));
}

TEST(ProgressLine, FitsItsRowAndTheNoteGivesWayFirst) {
  const ProgressState state{.done = 1234, .total = 8000, .rate_per_s = 23.4};
  const std::string note = "loss 1.2345, profit 480.1";
  const std::string whole = progress_line("train c51", "steps", state, note, 80);
  EXPECT_THAT(whole, EndsWith(note));
  for (std::size_t columns = 1; columns < 100; ++columns) {
    EXPECT_LE(progress_line("train c51", "steps", state, note, columns).size(), columns);
  }
  EXPECT_THAT(progress_line("train c51", "steps", state, note, 60), HasSubstr("ETA 289 s)  loss"));
  EXPECT_THAT(progress_line("train c51", "steps", state, note, 50), EndsWith("ETA 289 s)"));
  EXPECT_THAT(progress_line("fetch", "windows", state, "two\nlines\x1b[2J", 80),
              testing::Not(HasSubstr("\n")));
}

}  // namespace
}  // namespace bess
