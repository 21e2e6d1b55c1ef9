// File of the outside limit: absent, good, malformed, and cases that must never block the control
// thread.
#include "edge/app/storage/operator_files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cctype>
#include <string>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

struct ReadLimits {
  bool is_set = false;
  OutsideLimit limit;
  Status status;

  explicit ReadLimits(const std::string& path)
      : status(LimitFile{path.c_str()}.read(limit, is_set)) {}
};

TEST(LimitFile, AGoodLineIsALimitAndNoFileIsNone) {
  const TemporaryFolder folder;
  const ReadLimits none(folder.file("limit"));
  EXPECT_EQ(none.status, Status::kOk);
  EXPECT_FALSE(none.is_set);
  const ReadLimits reading(folder.write("limit", "1500 any 2023-03-26T00:15:00Z\n"));
  EXPECT_EQ(reading.status, Status::kOk);
  EXPECT_TRUE(reading.is_set);
  EXPECT_EQ(reading.limit.charge_w_max, 1'500);
}

TEST(LimitFile, WhatCannotBeUnderstoodIsMalformed) {
  const TemporaryFolder folder;
  for (const std::string& text :
       {std::string(), std::string("1500 any 2023-03-26T00:1"), std::string(4'096, '0'),
        std::string("1500 any 2023-03-26T00:15:00Z\n") + std::string(64, ' ')}) {
    const ReadLimits reading(folder.write("limit", text));
    EXPECT_EQ(reading.status, Status::kMalformed);
    EXPECT_FALSE(reading.is_set);
  }
}

/// Any program may write it, so it has no checksum: a flipped digit can be another limit. Nothing
/// else passes, and no damage reads as "no limit".
TEST(LimitFile, AFlippedBitIsMalformedOrAnotherDigit) {
  const TemporaryFolder folder;
  const std::string line = "1500 2750 2023-03-26T00:15:00Z\n";
  int accepted = 0;
  for (std::size_t bit = 0; bit < 8 * line.size(); ++bit) {
    std::string flipped = line;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    const ReadLimits reading(folder.write("limit", flipped));
    EXPECT_TRUE(reading.is_set || reading.status == Status::kMalformed) << flipped;
    if (!reading.is_set) continue;
    ++accepted;
    EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(line[bit / 8])) != 0 &&
                std::isdigit(static_cast<unsigned char>(flipped[bit / 8])) != 0)
        << flipped;
    EXPECT_TRUE(reading.limit.charge_w_max >= 0 && reading.limit.charge_w_max <= 9'999) << flipped;
  }
  EXPECT_GT(accepted, 0);
}

TEST(LimitFile, APipeOrAFolderIsNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo(folder.file("pipe").c_str(), 0600), 0);
  EXPECT_EQ(ReadLimits(folder.file("pipe")).status, Status::kMalformed);
  EXPECT_EQ(ReadLimits(folder.file("")).status, Status::kMalformed);
}

}  // namespace
}  // namespace bess
