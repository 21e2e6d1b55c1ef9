// Writing beside and renaming, and what must not be renamed over.
#include "shared/host/file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

class File : public testing::Test {
 protected:
  TemporaryFolder folder_;
  fs::path path_ = folder_.file("out.txt");
};

TEST_F(File, ReplacesAFileAndKeepsItsPermissions) {
  write_file(path_, "first");
  fs::permissions(path_, fs::perms::owner_read | fs::perms::owner_write);
  write_file(path_, "second");
  EXPECT_EQ(read_file(path_), "second");
  EXPECT_EQ(fs::status(path_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(File, ALinkStaysAndItsTargetIsReplaced) {
  const fs::path link = folder_.file("link.txt");
  write_file(path_, "first");
  fs::create_symlink(path_, link);
  write_file(link, "second");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_file(path_), "second");
}

TEST_F(File, APipeIsWrittenToAndStays) {
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  std::string received;
  std::thread reader([&] {
    std::ifstream pipe(path_);
    std::getline(pipe, received);
  });
  require_writable(path_);
  write_file(path_, "through\n");
  reader.join();
  EXPECT_EQ(received, "through");
  EXPECT_TRUE(fs::is_fifo(path_));
}

TEST_F(File, AFullDeviceIsAnErrorAndStaysADevice) {
  const fs::path full = "/dev/full";
  if (!fs::is_character_file(full)) GTEST_SKIP() << "needs /dev/full, which is absent";
  EXPECT_THROW(write_file(full, "text"), UserError);
  EXPECT_TRUE(fs::is_character_file(full));
}

/// Somebody else's link in the place of the temporary file must not lead the text anywhere.
TEST_F(File, APlantedLinkIsNotFollowed) {
  const std::string victim = folder_.write("victim", "precious");
  fs::create_symlink(victim, path_.string() + ".part." + std::to_string(getpid()));
  write_file(path_, "text");
  EXPECT_EQ(read_file(victim), "precious");
  EXPECT_EQ(read_file(path_), "text");
  EXPECT_FALSE(fs::is_symlink(path_));
}

TEST_F(File, WhatAKilledProcessLeftIsRemoved) {
  std::ofstream(path_.string() + ".part.999999999") << "partial";
  write_file(path_, "whole");
  EXPECT_FALSE(fs::exists(path_.string() + ".part.999999999"));
}

}  // namespace
}  // namespace bess
