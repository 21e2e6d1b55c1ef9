#include "workstation/sweep/run_here.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <map>

#include "shared/file_descriptor.h"
#include "shared/host/command_line.h"
#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/learn_task.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Programs at work, each on one task.
class TaskPrograms {
 public:
  TaskPrograms(const SweepFolder& folder, const TaskCommand& command)
      : command_(command), log_(open_log(folder)) {}

  void start(int task) {
    std::vector<std::string> arguments = command_;
    for (std::string& argument : arguments) {
      if (argument == "{}") argument = std::to_string(task);
    }
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, log_.get(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, log_.get(), STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setpgroup(&attributes, 0);  // Ctrl-C is ours to pass on
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    pid_t pid = -1;
    const int error = posix_spawnp(&pid, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) fail("{}: cannot be started: {}", command_[0], std::strerror(error));
    task_of_[pid] = task;
  }

  /// The task whose program ended, and how; 0 when none did within a tenth of a second.
  int ended(int& status) {
    for (int slice = 0; slice < 100; ++slice) {
      const pid_t pid = waitpid(-1, &status, WNOHANG);
      const auto found = task_of_.find(pid);
      if (pid > 0 && found != task_of_.end()) {
        const int task = found->second;
        task_of_.erase(found);
        return task;
      }
      usleep(1'000);
    }
    return 0;
  }

  void end_all() {
    for (const auto& [pid, task] : task_of_) kill(-pid, SIGTERM);
    for (const auto& [pid, task] : task_of_) waitpid(pid, nullptr, 0);
  }

  [[nodiscard]] std::size_t count() const { return task_of_.size(); }
  [[nodiscard]] const std::map<pid_t, int>& at_work() const { return task_of_; }

 private:
  static int open_log(const SweepFolder& folder) {
    fs::create_directories(folder.log());
    const fs::path path = folder.log() / "here.txt";
    const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (fd < 0) fail("{}: cannot write here: {}", path.string(), std::strerror(errno));
    return fd;
  }

  const TaskCommand& command_;
  FileDescriptor log_;
  std::map<pid_t, int> task_of_;
};

std::string end_text(const SweepFolder& folder, int task, int status) {
  if (fs::exists(folder.result(task))) {
    return is_proved(folder.result(task)) ? "proved" : "not proved";
  }
  if (WIFSIGNALED(status)) return fmt::format("killed by signal {}", WTERMSIG(status));
  return fmt::format("failed with exit code {}", WEXITSTATUS(status));
}

/// True when the task is to be tried again. A failure that could not be written down is counted
/// here.
bool is_to_be_tried(const SweepFolder& folder, int task, int tries) {
  if (fs::exists(folder.result(task))) return false;
  count_dead_attempts(folder, task);
  const std::size_t failures = failures_of(folder, task).size();
  return failures < std::size_t{kFailuresMax} && tries < kFailuresMax;
}

}  // namespace

RunHereResult run_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs,
                       const TaskCommand& command, std::FILE* messages) {
  watch_interruption();
  std::deque<int> waiting(tasks.begin(), tasks.end());
  std::map<int, int> tries;
  TaskPrograms programs(folder, command);
  RunHereResult result;
  const auto start = std::chrono::steady_clock::now();
  while (!waiting.empty() || programs.count() > 0) {
    while (!waiting.empty() && programs.count() < static_cast<std::size_t>(jobs)) {
      programs.start(waiting.front());
      waiting.pop_front();
    }
    int status = 0;
    const int task = programs.ended(status);
    if (interruption()) {
      const auto at_work = programs.at_work();
      programs.end_all();
      for (const auto& [pid, number] : at_work) forgive_attempts(folder, number);
      fmt::print(stderr, "what is done is kept: bess-train sweep run {} goes on\n",
                 folder.path.string());
      throw Interrupted{};
    }
    if (task == 0) continue;
    const bool is_again = is_to_be_tried(folder, task, ++tries[task]);
    if (is_again) waiting.push_back(task);
    result.ran += fs::exists(folder.result(task)) ? 1 : 0;
    result.failed += !is_again && !fs::exists(folder.result(task)) ? 1 : 0;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fmt::print(messages, "task {}: {}{} ({} of {}, {:.0f} s)\n", task,
               end_text(folder, task, status), is_again ? ", is tried again" : "",
               result.ran + result.failed, tasks.size(), taken.count());
    std::fflush(messages);
  }
  return result;
}

}  // namespace bess
