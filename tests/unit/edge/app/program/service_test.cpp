// Service interfaces of the controller: lock files, systemd's notify socket, journal levels.
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>

#include "edge/app/program/service_notify.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/records/log/journal.h"
#include "shared/scaled_clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::StartsWith;

TEST(InstanceLock, TheSecondIsRefusedWithTheFirstOnesProcess) {
  const TemporaryFolder folder;
  const std::string path = folder.file("lock");
  FileMessage error;
  InstanceLock first;
  ASSERT_TRUE(first.take(path.c_str(), "the battery", error)) << error.c_str();
  InstanceLock second;
  EXPECT_FALSE(second.take(path.c_str(), "the battery", error));
  EXPECT_THAT(error.c_str(), Names("battery " + std::to_string(getpid()) + " " + path));
  EXPECT_EQ(lock_owner_pid(path.c_str()), getpid());
}

TEST(InstanceLock, IsFreeAfterItsHolderHasGoneHoweverItWent) {
  const TemporaryFolder folder;
  const std::string path = folder.file("lock");
  FileMessage error;
  const pid_t child = fork();
  if (child == 0) {
    InstanceLock lock;
    FileMessage message;
    _exit(lock.take(path.c_str(), "x", message) ? 7 : 8);  // no destructor: the file stays behind
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_EQ(WEXITSTATUS(status), 7);
  EXPECT_TRUE(std::filesystem::exists(path));
  EXPECT_EQ(lock_owner_pid(path.c_str()), 0);
  {
    InstanceLock lock;
    EXPECT_TRUE(lock.take(path.c_str(), "x", error)) << error.c_str();
  }
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(lock_owner_pid(path.c_str()), 0);
}

/// The owner removes the file: a lock on the removed file must not count.
TEST(InstanceLock, ManyTakersAreNeverInsideTogether) {
  const TemporaryFolder folder;
  const std::string path = folder.file("lock");
  const std::string inside = folder.file("inside");
  void* const shared = mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE,
                            MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(shared, MAP_FAILED);
  auto& waits = *new (shared) std::atomic<int>(0);
  for (int i = 0; i < 4; ++i) {
    if (fork() != 0) continue;
    int taken = 0;
    for (int round = 0; round < 200; ++round) {
      InstanceLock lock;
      FileMessage error;
      const std::int64_t start_ns = clock_ns(CLOCK_MONOTONIC);
      if (!lock.take(path.c_str(), "x", error)) continue;
      if (clock_ns(CLOCK_MONOTONIC) - start_ns > kNanosecondsPerSecond / 20) ++waits;
      if (mkdir(inside.c_str(), 0755) != 0) _exit(1);  // another process is inside
      sched_yield();                                   // lets the others try
      if (rmdir(inside.c_str()) != 0) _exit(2);
      ++taken;
    }
    _exit(taken > 0 ? 0 : 3);
  }
  int status = 0;
  while (wait(&status) > 0) EXPECT_EQ(status, 0);
  EXPECT_GT(waits, 0) << "no contention occurred";
  munmap(shared, sizeof(std::atomic<int>));
}

TEST(InstanceLock, AFolderThatIsNotThereIsOneLine) {
  InstanceLock lock;
  FileMessage error;
  EXPECT_FALSE(lock.take("/nonexistent/lock", "x", error));
  EXPECT_THAT(error.c_str(), Names("/nonexistent/lock"));
}

/// systemd's end of the notify socket.
class NotifySocket {
 public:
  explicit NotifySocket(const std::string& name) : fd_(socket(AF_UNIX, SOCK_DGRAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, name.data(), name.size());
    if (name[0] == '@') address.sun_path[0] = '\0';
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), size), 0);
    setenv("NOTIFY_SOCKET", name.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    close(fd_);
  }
  std::string receive() const {
    char text[512];
    const ssize_t size = recv(fd_, text, sizeof text, MSG_DONTWAIT);
    return size < 0 ? "" : std::string(text, static_cast<std::size_t>(size));
  }

 private:
  int fd_;
};

CycleRecord record_with_missed_ticks(std::int32_t missed_ticks) {
  CycleRecord record;
  record.mode = Mode::kRunning;
  record.missed_ticks = missed_ticks;
  return record;
}

TEST(ServiceNotify, SendsToAFileSocketAndToAnAbstractOne) {
  const TemporaryFolder folder;
  const std::string abstract = "@bess-test-" + std::to_string(getpid());
  for (const std::string& name : {folder.file("notify"), abstract}) {
    const NotifySocket systemd(name);
    ServiceNotify notify;
    notify.extend_start(70);
    EXPECT_EQ(systemd.receive(), "EXTEND_TIMEOUT_USEC=70000000") << name;
    notify.ready();
    EXPECT_THAT(systemd.receive(), StartsWith("READY=1\n")) << name;
    notify.stopping();
    EXPECT_THAT(systemd.receive(), StartsWith("STOPPING=1\n")) << name;
  }
}

TEST(ServiceNotify, TheWatchdogIsRefreshedByCyclesInTimeOnly) {
  const TemporaryFolder folder;
  const NotifySocket systemd(folder.file("notify"));
  ServiceNotify notify;
  notify.cycle_done(record_with_missed_ticks(0));
  EXPECT_THAT(systemd.receive(), Names("WATCHDOG=1 STATUS=running 0 W"));
  notify.cycle_done(record_with_missed_ticks(1));
  EXPECT_THAT(systemd.receive(), StartsWith("STATUS=running"));
  notify.cycle_done(record_with_missed_ticks(1));
  EXPECT_THAT(systemd.receive(), StartsWith("WATCHDOG=1\n"));
}

TEST(ServiceNotify, NeitherAMissingNorAFullSocketMatters) {
  unsetenv("NOTIFY_SOCKET");
  ServiceNotify absent;
  absent.ready();
  const TemporaryFolder folder;
  const NotifySocket systemd(folder.file("notify"));
  ServiceNotify notify;
  for (int i = 0; i < 5'000; ++i) notify.cycle_done(record_with_missed_ticks(0));  // must not wait
  EXPECT_THAT(systemd.receive(), StartsWith("WATCHDOG=1"));
}

TEST(Journal, LevelsAppearOnlyOnTheStreamThatLeadsThere) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  struct stat info {};
  ASSERT_EQ(fstat(ends[1], &info), 0);
  unsetenv("JOURNAL_STREAM");
  EXPECT_STREQ(journal_prefix(ends[1], JournalLevel::kError), "");
  const std::string stream = std::to_string(info.st_dev) + ":" + std::to_string(info.st_ino);
  setenv("JOURNAL_STREAM", stream.c_str(), 1);
  EXPECT_STREQ(journal_prefix(ends[1], JournalLevel::kError), "<3>");
  EXPECT_STREQ(journal_prefix(ends[1], JournalLevel::kWarning), "<4>");
  EXPECT_STREQ(journal_prefix(ends[1], JournalLevel::kNotice), "<5>");
  EXPECT_STREQ(journal_prefix(ends[1], JournalLevel::kInfo), "<6>");
  EXPECT_STREQ(journal_prefix(STDOUT_FILENO, JournalLevel::kError), "");  // redirected elsewhere
  unsetenv("JOURNAL_STREAM");
  close(ends[0]);
  close(ends[1]);
}

}  // namespace
}  // namespace bess
