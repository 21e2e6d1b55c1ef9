#include "shared/host/text.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

const std::vector<std::string> kWords = {"train", "distil", "verify", "--resume", "--prices"};

TEST(NearestWord, FindsWhatWasProbablyMeant) {
  EXPECT_EQ(nearest_word("tarin", kWords), "train") << "two letters swapped";
  EXPECT_EQ(nearest_word("distill", kWords), "distil") << "a letter too many";
  EXPECT_EQ(nearest_word("verfy", kWords), "verify") << "a letter missing";
  EXPECT_EQ(nearest_word("--resune", kWords), "--resume") << "another letter";
  EXPECT_EQ(nearest_word("--pri", kWords), "--prices") << "its beginning";
}

TEST(NearestWord, IsSilentAboutWhatIsFarFromAll) {
  EXPECT_EQ(nearest_word("backtest", kWords), "");
  EXPECT_EQ(nearest_word("x", kWords), "") << "too short to tell";
  EXPECT_EQ(nearest_word(std::string(100'000, 'a'), kWords), "");
  EXPECT_EQ(nearest_word("train", {}), "");
}

TEST(NearestWord, AsPartOfAMessage) {
  EXPECT_EQ(did_you_mean("tran", kWords), "; did you mean train?");
  EXPECT_EQ(did_you_mean("zzz", kWords), "");
}

}  // namespace
}  // namespace bess
