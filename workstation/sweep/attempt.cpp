#include "workstation/sweep/attempt.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <fstream>

#include "shared/crc32.h"
#include "shared/file_descriptor.h"
#include "shared/host/command_line.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/run/run_folder.h"
#include "workstation/run/run_record.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

std::string first_line(const char* path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// Host, and what tells its boots and its containers apart.
const std::string& machine() {
  static const std::string kName = [] {
    char host[256] = "host";
    gethostname(host, sizeof host - 1);
    std::error_code error;
    const std::string here = first_line("/proc/sys/kernel/random/boot_id") +
                             fs::read_symlink("/proc/self/ns/pid", error).string();
    Crc32 crc;
    crc.add_bytes(here.data(), here.size());
    std::string name(host);
    std::ranges::replace(name, '.', '-');
    return fmt::format("{}.{:08x}", name, crc.value());
  }();
  return kName;
}

/// When a program of this number was started, in ticks since the boot; empty when there is none.
std::string start_of(const std::string& pid) {
  const std::string stat = first_line(("/proc/" + pid + "/stat").c_str());
  std::size_t at = stat.rfind(')');  // its name may hold anything
  constexpr int kFieldsBetween = 20;
  for (int field = 0; field < kFieldsBetween && at != stat.npos; ++field) {
    at = stat.find(' ', at + 1);
  }
  if (at == stat.npos) return {};
  const std::size_t end = stat.find(' ', at + 1);
  return stat.substr(at + 1, end - at - 1);
}

std::vector<fs::path> entries_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) paths.push_back(entry.path());
  std::ranges::sort(paths);
  return paths;
}

void sync_folder(const fs::path& folder) {
  const FileDescriptor fd(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() >= 0) fsync(fd.get());
}

/// False when something of that name is there. A file system that does not know RENAME_NOREPLACE
/// gets the plain one, which replaces no folder that holds something either.
bool publish(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno == EINVAL || errno == ENOSYS) {
    if (rename(from.c_str(), to.c_str()) == 0) return true;
  }
  if (errno == EEXIST || errno == ENOTEMPTY) return false;
  fail("{}: cannot be published as {}: {}", from.string(), to.string(), std::strerror(errno));
}

char own_attempt[PATH_MAX];
char ended_attempt[PATH_MAX];

void rename_as_ended() { rename(own_attempt, ended_attempt); }

/// Who is ended on purpose says so by a rename, which a signal's handler may do.
void say_when_ended(const fs::path& own) {
  const std::string ended = own.string() + kEnded;
  if (ended.size() >= PATH_MAX) return;  // then it counts as killed
  std::strcpy(own_attempt, own.c_str());
  std::strcpy(ended_attempt, ended.c_str());
  before_interrupted_end(rename_as_ended);
}

/// What was made but cannot be published, as nobody may write there, is no failure of the task.
bool publish_made(const SweepFolder& folder, int task, const fs::path& own) {
  try {
    fs::create_directories(folder.result(task).parent_path());
    return publish(own, folder.result(task));
  } catch (const std::exception&) {
    rename_as_ended();
    throw;
  }
}

/// Under the name of who failed: counted once, whoever tells of it.
void note_failure(const SweepFolder& folder, int task, const std::string& who,
                  const std::string& why) {
  const fs::path path = folder.failures(task) / who;
  std::error_code error;
  if (fs::exists(path, error)) return;
  try {
    write_file(path, one_line(why, 1'000) + "\n");
  } catch (const UserError&) {  // a full disk: then it is not counted, and the disk is the matter
  }
}

bool is_left(const std::string& who) { return who.ends_with(kEnded) || is_gone(who); }

/// In the folder of an attempt that was left, or in an empty one.
fs::path begin_attempt(const SweepFolder& folder, int task) {
  const fs::path own = folder.attempts(task) / own_name();
  fs::create_directories(folder.attempts(task));
  say_when_ended(own);
  for (const fs::path& left : entries_in(folder.attempts(task))) {
    if (!is_left(left.filename().string())) continue;
    if (rename(left.c_str(), own.c_str()) == 0) return own;  // one of several gets it
  }
  fs::create_directories(own);
  return own;
}

/// What nobody is at work in; and the folder of attempts once it is empty.
void clear_attempts(const SweepFolder& folder, int task) {
  std::error_code error;
  for (const fs::path& left : entries_in(folder.attempts(task))) {
    const std::string who = left.filename().string();
    if (who == own_name() || is_left(who)) fs::remove_all(left, error);
  }
  fs::remove(folder.attempts(task), error);
}

/// What is no result, or another one: nothing is thrown away.
void set_aside(const SweepFolder& folder, int task, const fs::path& what) {
  std::error_code error;
  fs::create_directories(folder.different(), error);
  fs::rename(what, folder.different() / (SweepFolder::number_text(task) + "." + own_name()), error);
}

TaskEnd compare_with_published(const SweepFolder& folder, int task, const fs::path& own) {
  if (marks_of_folder(own) == marks_of_folder(folder.result(task))) return TaskEnd::kSame;
  set_aside(folder, task, own);
  return TaskEnd::kDifferent;
}

}  // namespace

std::string own_name() {
  const std::string pid = std::to_string(getpid());
  return fmt::format("{}.{}.{}", machine(), pid, start_of(pid));
}

bool is_gone(const std::string& who) {
  if (!who.starts_with(machine() + ".")) return false;
  const std::string rest = who.substr(machine().size() + 1);
  const std::size_t dot = rest.find('.');
  return dot != rest.npos && start_of(rest.substr(0, dot)) != rest.substr(dot + 1);
}

std::vector<std::string> marks_of_folder(const fs::path& folder) {
  std::vector<std::string> marks;
  for (const fs::path& path : entries_in(folder)) {
    const std::string name = path.filename().string();
    if (name != run_file::kTimes) marks.push_back(name + ": " + file_mark(path));
  }
  return marks;
}

std::vector<std::string> failures_of(const SweepFolder& folder, int task) {
  std::vector<std::string> failures;
  for (const fs::path& path : entries_in(folder.failures(task))) {
    if (path.filename().string().find(".part.") != std::string::npos) continue;
    failures.push_back(path.filename().string() + ": " + first_line(path.c_str()));
  }
  return failures;
}

void count_dead_attempts(const SweepFolder& folder, int task) {
  for (const fs::path& left : entries_in(folder.attempts(task))) {
    const std::string who = left.filename().string();
    const bool is_killed = is_gone(who) && !who.ends_with(kEnded);
    if (is_killed) note_failure(folder, task, who, "was killed, or its machine went down");
  }
}

bool is_published(const SweepFolder& folder, int task) {
  std::error_code error;
  return fs::exists(folder.result(task) / run_file::kRecord, error);
}

TaskEnd attempt_task(const SweepFolder& folder, int task, const TaskWork& work) {
  if (is_published(folder, task)) {
    clear_attempts(folder, task);
    return TaskEnd::kAlreadyThere;
  }
  if (fs::exists(folder.result(task))) set_aside(folder, task, folder.result(task));
  count_dead_attempts(folder, task);
  const std::vector<std::string> before = failures_of(folder, task);
  if (before.size() >= static_cast<std::size_t>(kFailuresMax)) {
    fail("task {} failed {} times, last: {}; mend it and remove {} to have it tried again", task,
         before.size(), before.back(), folder.failures(task).string());
  }
  const fs::path own = begin_attempt(folder, task);
  try {
    work(own);
  } catch (const Interrupted&) {  // it has saved how far it was
    rename_as_ended();
    throw;
  } catch (const std::exception& error) {
    note_failure(folder, task, own_name(), error.what());
    std::error_code ignored;
    fs::remove_all(own, ignored);
    throw;
  }
  sync_folder(own);
  const bool is_first = publish_made(folder, task, own);
  if (is_first) sync_folder(folder.result(task).parent_path());
  const TaskEnd end = is_first ? TaskEnd::kPublished : compare_with_published(folder, task, own);
  clear_attempts(folder, task);
  return end;
}

}  // namespace bess
