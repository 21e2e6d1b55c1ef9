#include <gtest/gtest.h>

#include <algorithm>

#include "workstation/report/page_data.h"

namespace bess {
namespace {

TEST(StepArchive, Base64IsThatOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\x00"), "//4=");  // the literal ends at its zero
}

TEST(StepArchive, FewDaysAreAllKept) {
  EXPECT_EQ(days_with_steps({3, 1, 2}, 5), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(days_with_steps({}, 5).empty());
}

TEST(StepArchive, OfManyTheWorstAndTheNewestAreKept) {
  std::vector<double> profits(400, 100.0);
  profits[7] = -50;
  profits[3] = -60;
  const std::vector<std::size_t> kept = days_with_steps(profits, 100);
  ASSERT_EQ(kept.size(), 100u);
  EXPECT_TRUE(std::ranges::is_sorted(kept));
  EXPECT_NE(std::ranges::find(kept, 7u), kept.end());
  EXPECT_NE(std::ranges::find(kept, 3u), kept.end());
  EXPECT_EQ(kept.back(), 399u);
  EXPECT_EQ(kept[kWorstDaysKept], 400u - (100 - kWorstDaysKept));  // the newest from here on
}

}  // namespace
}  // namespace bess
