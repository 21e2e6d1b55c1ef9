// Files that are replaced atomically, in a folder that others may write to.
#include "edge/records/log/atomic_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "edge/records/log/ring_log.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

TEST(AtomicFile, APlantedLinkIsNotFollowed) {
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

TEST(AtomicFile, APlantedLinkDoesNotLeadTheNewLogAway) {
  const TemporaryFolder folder;
  const std::string victim = folder.write("victim", "precious");
  const std::string path = folder.file("decisions.ring");
  fs::create_symlink(victim, path + ".new");
  RingLog ring;
  FileMessage error;
  ASSERT_TRUE(ring.open(path.c_str(), 5, error)) << error.c_str();
  EXPECT_EQ(text_of_file(victim), "precious");
}

TEST(AtomicFile, TheTemporaryFileOfAKilledProgramIsReplaced) {
  const TemporaryFolder folder;
  const std::string path = folder.file("status.json");
  folder.write("status.json.new", "half of a longer te");
  EXPECT_TRUE(replace_file(path.c_str(), "now"));
  EXPECT_EQ(text_of_file(path), "now");
  EXPECT_FALSE(fs::exists(path + ".new"));
}

TEST(AtomicFile, AFolderInTheWayIsAnError) {
  const TemporaryFolder folder;
  const std::string path = folder.file("status.json");
  fs::create_directory(path + ".new");
  EXPECT_FALSE(replace_file(path.c_str(), "now"));
  EXPECT_FALSE(is_disk_trouble(errno)) << "the operator must fix it";
}

/// Creates files under a restrictive umask of root.
class CarefulRoot : public ::testing::Test {
 protected:
  static constexpr uid_t kService = 65'534;

  CarefulRoot() : umask_before_(umask(077)) {}
  CarefulRoot(const CarefulRoot&) = delete;
  CarefulRoot& operator=(const CarefulRoot&) = delete;
  ~CarefulRoot() override { umask(umask_before_); }

  std::string make(const char* name, mode_t folder_mode) {
    EXPECT_EQ(chmod(folder_.file("").c_str(), folder_mode), 0);
    EXPECT_TRUE(replace_file_durably(folder_.file(name).c_str(), "text"));
    return folder_.file(name);
  }
  static mode_t mode_of(const std::string& path) { return facts_of(path).st_mode & 07777; }
  static struct stat facts_of(const std::string& path) {
    struct stat facts {};
    EXPECT_EQ(stat(path.c_str(), &facts), 0);
    return facts;
  }

  const TemporaryFolder folder_;

 private:
  mode_t umask_before_;
};

TEST_F(CarefulRoot, FilesAreReadableForAllWhoMayEnterTheFolder) {
  EXPECT_EQ(mode_of(make("for_all", 0755)), 0644U);
  EXPECT_EQ(mode_of(make("for_the_group", 0750)), 0640U);
  EXPECT_EQ(mode_of(make("for_one", 0700)), 0600U);
  EXPECT_EQ(mode_of(make("of_everybody", 01777)), 0644U) << "no other user may write";
}

TEST_F(CarefulRoot, WhatRootMakesBelongsToTheFoldersOwner) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give a folder to another user";
  ASSERT_EQ(chown(folder_.file("").c_str(), kService, kService), 0);
  const std::string made = folder_.file("made");
  ASSERT_TRUE(make_folder(made.c_str()));
  ASSERT_TRUE(make_folder(made.c_str())) << "it is there";
  for (const std::string& path : {make("hold", 0755), made}) {
    EXPECT_EQ(facts_of(path).st_uid, kService) << path;
    EXPECT_EQ(facts_of(path).st_gid, kService) << path;
  }
  EXPECT_EQ(mode_of(made), 0755U);
  EXPECT_FALSE(make_folder("/proc/bess"));
}

}  // namespace
}  // namespace bess
