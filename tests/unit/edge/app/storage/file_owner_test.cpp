// Files possibly made by another user. Only root can act as another user: otherwise these are
// skipped.
#include "edge/app/storage/instance_lock.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr uid_t kStranger = 65'534;

class FileOwner : public ::testing::Test {
 protected:
  void SetUp() override {
    if (geteuid() != 0) GTEST_SKIP() << "needs root, to give a file to another user";
  }
  /// A file as that user would have made it, writable by everyone.
  std::string strangers(const std::string& name) const {
    std::string path = folder_.write(name, "");
    EXPECT_EQ(chmod(path.c_str(), 0666), 0);
    EXPECT_EQ(chown(path.c_str(), kStranger, kStranger), 0);
    return path;
  }

  const TemporaryFolder folder_;
  FileMessage error_;
};

TEST_F(FileOwner, AnotherUsersLockIsRefusedWithTheRemedy) {
  const std::string path = strangers("bess-127.0.0.1_502_unit_85.lock");
  InstanceLock lock;
  EXPECT_FALSE(lock.take(path.c_str(), "the battery", error_));
  EXPECT_THAT(error_.c_str(), Names(path + " 65534"));
  EXPECT_EQ(access(path.c_str(), F_OK), 0) << "owned by another user";
}

TEST_F(FileOwner, AnotherUsersStatusOrLogIsRefusedBeforeTheStart) {
  for (const char* name : {"status.bin", "decisions.ring"}) {
    const TemporaryFolder state;
    EdgeConfig config;
    config.state.folder = state.file("").c_str();
    config.log.status = state.file("status.json").c_str();
    config.log.ring = state.file("decisions.ring").c_str();
    ASSERT_EQ(chown(state.write(name, "{}").c_str(), kStranger, kStranger), 0);
    RunLocks locks;
    EXPECT_FALSE(lock_state(config, locks, error_));
    EXPECT_THAT(error_.c_str(), Names(state.file(name) + " 65534"));
  }
}

/// Anyone who may open a file can hold its lock, and so prevent the controller from starting.
TEST_F(FileOwner, NoOtherUserMayOpenTheLock) {
  const std::string path = folder_.write("lock", "");
  ASSERT_EQ(chmod(path.c_str(), 0666), 0);  // as an older version made it
  ASSERT_EQ(chmod(folder_.file("").c_str(), 0755), 0);
  InstanceLock lock;
  ASSERT_TRUE(lock.take(path.c_str(), "the battery", error_)) << error_.c_str();
  const pid_t child = fork();
  if (child == 0) {
    if (setgid(kStranger) != 0 || setuid(kStranger) != 0) _exit(1);
    if (open(path.c_str(), O_RDONLY | O_CLOEXEC) >= 0) _exit(2);
    _exit(lock_owner_pid(path.c_str()) == kOwnerHidden ? 0 : 3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

/// A reader also trusts the folder's owner, who can put any file there, and no other user.
TEST_F(FileOwner, AReaderBelievesTheOwnerOfTheFolder) {
  const std::string path = strangers("status.json");
  EXPECT_FALSE(is_believable(path.c_str()));
  EXPECT_EQ(lock_owner_pid(path.c_str()), 0);
  ASSERT_EQ(chown(folder_.file("").c_str(), kStranger, kStranger), 0);
  EXPECT_TRUE(is_believable(path.c_str()));
  EXPECT_TRUE(is_believable(folder_.file("none").c_str()));
}

}  // namespace
}  // namespace bess
