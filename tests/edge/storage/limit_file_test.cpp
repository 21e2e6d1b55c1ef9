// The file of the outside limit: absent, good, malformed, and what must never make the control
// thread wait.
#include "edge/storage/limit_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

struct Reading {
  bool is_set = false;
  OutsideLimit limit;
  Status status;

  explicit Reading(const std::string& path) : status(LimitFile(path.c_str()).read(limit, is_set)) {}
};

TEST(LimitFile, NoFileIsNoLimit) {
  const TemporaryFolder folder;
  const Reading reading(folder.file("limit"));
  EXPECT_EQ(reading.status, Status::kOk);
  EXPECT_FALSE(reading.is_set);
}

TEST(LimitFile, AGoodLineIsALimit) {
  const TemporaryFolder folder;
  const Reading reading(folder.write("limit", "1500 any 2023-03-26T00:15:00Z\n"));
  EXPECT_EQ(reading.status, Status::kOk);
  EXPECT_TRUE(reading.is_set);
  EXPECT_EQ(reading.limit.charge_w_max, 1'500);
}

TEST(LimitFile, WhatCannotBeUnderstoodIsMalformed) {
  const TemporaryFolder folder;
  for (const std::string& text :
       {std::string(), std::string("1500 any 2023-03-26T00:1"), std::string(4'096, '0'),
        std::string("1500 any 2023-03-26T00:15:00Z\n") + std::string(64, ' ')}) {
    const Reading reading(folder.write("limit", text));
    EXPECT_EQ(reading.status, Status::kMalformed);
    EXPECT_FALSE(reading.is_set);
  }
}

TEST(LimitFile, APipeOrAFolderIsNotWaitedFor) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo(folder.file("pipe").c_str(), 0600), 0);
  EXPECT_EQ(Reading(folder.file("pipe")).status, Status::kMalformed);
  EXPECT_EQ(Reading(folder.file("")).status, Status::kMalformed);
}

}  // namespace
}  // namespace bess
