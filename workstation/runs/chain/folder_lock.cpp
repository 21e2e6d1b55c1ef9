#include "workstation/runs/chain/folder_lock.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <string_view>
#include <thread>

#include "shared/host/file.h"
#include "shared/host/user_error.h"

namespace bess {

namespace {

constexpr int kExitInterrupted = 3;
constexpr int kExitInterruptedTwice = 130;  // shell convention for a program killed by Ctrl-C

char note_text[512] = "";  // a signal handler must not allocate
std::atomic<std::size_t> note_size{0};

void say(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

[[noreturn]] void end_now(int exit_code) {
  remove_unfinished_files();
  say("\n");
  say({note_text, note_size.load()});
  say("bess-train: interrupted\n");
  _exit(exit_code);
}

void handle_with(void (*handler)(int)) {
  std::signal(SIGINT, handler);
  std::signal(SIGTERM, handler);
}

[[noreturn]] void at_work(const std::filesystem::path& place) {
  fail("{}: in use by another bess-train; wait for it, or choose another --out", place.string());
}

/// For file systems without locks, as on many clusters.
void warn_unlocked(const std::filesystem::path& place) {
  fmt::print(
      stderr,
      "bess-train: warning: {}: its file system has no locks ({}): do not run another bess-train "
      "here at the same time [no-lock]\n",
      place.string(), std::strerror(errno));
}

/// A program deletes its lock file when it ends; a lock on a deleted file is not valid.
bool is_still_there(int fd, const std::filesystem::path& path) {
  struct stat held {};
  struct stat named {};
  return fstat(fd, &held) == 0 && stat(path.c_str(), &named) == 0 && held.st_ino == named.st_ino &&
         held.st_dev == named.st_dev;
}

}  // namespace

void end_when_interrupted(const std::string& note) {
  const std::string line = note.empty() ? "" : note + "\n";
  note_size = 0;
  const std::size_t size = std::min(line.size(), sizeof note_text);
  std::copy_n(line.data(), size, note_text);
  note_size = size;
  handle_with([](int) { end_now(kExitInterrupted); });
}

std::atomic<bool>& interruption() {
  static std::atomic<bool> interrupted{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
  return interrupted;
}

void watch_interruption() {
  interruption();  // constructed before the first signal
  handle_with([](int) {
    if (interruption().exchange(true)) end_now(kExitInterruptedTwice);
  });
}

std::function<bool()> watch_from_first_call() {
  return [watching = false]() mutable {
    if (!watching) watch_interruption();
    watching = true;
    return interruption().load();
  };
}

void sleep_unless(double seconds, const std::atomic<bool>& interrupted) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!interrupted && Clock::now() < end) {
    const std::chrono::duration<double> left = end - Clock::now();
    std::this_thread::sleep_for(std::min(left, std::chrono::duration<double>(0.1)));
  }
}

FolderLock::FolderLock(const std::filesystem::path& folder, LockScope what)
    : fd_(open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  const int kind = what == LockScope::kFolder ? LOCK_EX : LOCK_SH;
  if (fd_.get() < 0 || flock(fd_.get(), kind | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) at_work(folder);
  warn_unlocked(folder);
}

FileLock::FileLock(const std::filesystem::path& file) : path_(file.string() + ".lock") {
  do {
    fd_.emplace(open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
    if (fd_->get() < 0) return;  // write permission is checked elsewhere
    if (flock(fd_->get(), LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) at_work(file);
      warn_unlocked(file);
      return;
    }
  } while (!is_still_there(fd_->get(), path_));
}

FileLock::~FileLock() {
  if (fd_->get() >= 0) unlink(path_.c_str());
}

}  // namespace bess
