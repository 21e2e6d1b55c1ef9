// Files that are replaced at once, in a folder where others may write as well.
#include "edge/log/whole_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <filesystem>

#include "edge/log/ring_log.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

TEST(WholeFile, APlantedLinkIsNotFollowed) {
  const TemporaryFolder folder;
  const std::string victim = folder.write("victim", "precious");
  const std::string path = folder.file("status.json");
  fs::create_symlink(victim, path + ".new");
  EXPECT_TRUE(replace_file(path.c_str(), "now"));
  EXPECT_EQ(text_of_file(victim), "precious");
  EXPECT_EQ(text_of_file(path), "now");
  EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path)));
  fs::create_symlink(victim, path + ".new");
  EXPECT_TRUE(replace_file_durably(path.c_str(), "later"));
  EXPECT_EQ(text_of_file(victim), "precious");
}

TEST(WholeFile, APlantedLinkDoesNotLeadTheNewLogAway) {
  const TemporaryFolder folder;
  const std::string victim = folder.write("victim", "precious");
  const std::string path = folder.file("decisions.ring");
  fs::create_symlink(victim, path + ".new");
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(path.c_str(), 5, error)) << error.c_str();
  EXPECT_EQ(text_of_file(victim), "precious");
}

TEST(WholeFile, WhatAKilledProgramLeftBesideIsReplaced) {
  const TemporaryFolder folder;
  const std::string path = folder.file("status.json");
  static_cast<void>(folder.write("status.json.new", "half of a longer te"));
  EXPECT_TRUE(replace_file(path.c_str(), "now"));
  EXPECT_EQ(text_of_file(path), "now");
  EXPECT_FALSE(fs::exists(path + ".new"));
}

TEST(WholeFile, AFolderInTheWayIsAnError) {
  const TemporaryFolder folder;
  const std::string path = folder.file("status.json");
  fs::create_directory(path + ".new");
  EXPECT_FALSE(replace_file(path.c_str(), "now"));
  EXPECT_FALSE(is_disk_trouble(errno)) << "the operator's to mend";
}

}  // namespace
}  // namespace bess
