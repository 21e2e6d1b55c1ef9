#include "workstation/sweep/run_here.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <signal.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <initializer_list>
#include <map>
#include <string>

#include "shared/file_descriptor.h"
#include "shared/host/command_line.h"
#include "shared/host/user_error.h"
#include "workstation/chain/interruption.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/learn_task.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

sigset_t set_of(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

/// Signals that wait for as long as this lives.
class HeldSignals {
 public:
  HeldSignals(std::initializer_list<int> signals) {
    const sigset_t held = set_of(signals);
    sigprocmask(SIG_BLOCK, &held, &before_);
  }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  ~HeldSignals() { sigprocmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_{};
};

/// Processes at work, each on one task.
class TaskProcesses {
 public:
  TaskProcesses(const SweepFolder& folder, const TaskProgram& program)
      : program_(program), log_(open_log(folder)) {}

  void start(int task) {
    std::fflush(nullptr);                     // or the child says again what waits to be said
    const HeldSignals held{SIGINT, SIGTERM};  // until the child can take them
    const pid_t pid = fork();
    if (pid < 0) fail("task {}: cannot be started: {}", task, std::strerror(errno));
    if (pid == 0) be_child(task);
    setpgid(pid, pid);  // Ctrl-C is ours to pass on; whoever is first
    task_of_[pid] = task;
  }

  /// The task whose process ended, and how; 0 when none did within a tenth of a second.
  int ended(int& status) {
    pid_t pid = waitpid(-1, &status, WNOHANG);
    if (pid == 0) {
      constexpr timespec kTenth{0, 100'000'000};
      const sigset_t child_ended = set_of({SIGCHLD});
      sigtimedwait(&child_ended, nullptr, &kTenth);
      pid = waitpid(-1, &status, WNOHANG);
    }
    const auto found = task_of_.find(pid);
    if (found == task_of_.end()) return 0;
    const int task = found->second;
    task_of_.erase(found);
    return task;
  }

  void end_all() {
    for (const auto& [pid, task] : task_of_) kill(-pid, SIGTERM);
    for (const auto& [pid, task] : task_of_) waitpid(pid, nullptr, 0);
  }

  [[nodiscard]] std::size_t count() const { return task_of_.size(); }

 private:
  [[noreturn]] void be_child(int task) const {
    setpgid(0, 0);
    dup2(log_.get(), STDOUT_FILENO);
    dup2(log_.get(), STDERR_FILENO);
    end_when_interrupted("what task " + std::to_string(task) + " made is kept");
    const sigset_t none = set_of({});
    sigprocmask(SIG_SETMASK, &none, nullptr);
    int exit_code = 0;
    try {
      program_(task);
    } catch (const Interrupted&) {
      exit_code = 3;
    } catch (const std::exception& error) {
      fmt::print(stderr, "task {}: {}\n", task, error.what());
      exit_code = 1;
    }
    std::fflush(nullptr);
    _exit(exit_code);  // what the parent holds is its own to take down
  }

  static int open_log(const SweepFolder& folder) {
    fs::create_directories(folder.log());
    const fs::path path = folder.log() / "here.txt";
    const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (fd < 0) fail("{}: cannot write here: {}", path.string(), std::strerror(errno));
    return fd;
  }

  const HeldSignals held_{SIGCHLD};  ///< is waited for
  const TaskProgram& program_;
  FileDescriptor log_;
  std::map<pid_t, int> task_of_;
};

std::string end_text(const SweepFolder& folder, int task, int status) {
  if (is_published(folder, task)) {
    return is_proved(folder.result(task)) ? "proved" : "not proved";
  }
  if (WIFSIGNALED(status)) return fmt::format("killed by signal {}", WTERMSIG(status));
  return fmt::format("failed with exit code {}", WEXITSTATUS(status));
}

/// True when the task is to be tried again. A failure that could not be written down is counted
/// here.
bool is_to_be_tried(const SweepFolder& folder, int task, int tries) {
  if (is_published(folder, task)) return false;
  count_dead_attempts(folder, task);
  const std::size_t failures = failures_of(folder, task).size();
  return failures < std::size_t{kFailuresMax} && tries < kFailuresMax;
}

}  // namespace

RunHereResult run_here(const SweepFolder& folder, const std::vector<int>& tasks, int jobs,
                       const TaskProgram& program, std::FILE* messages) {
  watch_interruption();
  std::deque<int> waiting(tasks.begin(), tasks.end());
  std::map<int, int> tries;
  TaskProcesses processes(folder, program);
  RunHereResult result;
  const auto start = std::chrono::steady_clock::now();
  while (!waiting.empty() || processes.count() > 0) {
    while (!waiting.empty() && processes.count() < static_cast<std::size_t>(jobs)) {
      const int task = waiting.front();
      waiting.pop_front();
      if (is_published(folder, task)) {
        ++result.ran;
      } else {
        processes.start(task);
      }
    }
    int status = 0;
    const int task = processes.ended(status);
    if (interruption()) {
      processes.end_all();
      fmt::print(stderr, "what is done is kept: bess-train sweep run {} goes on\n",
                 folder.path.string());
      throw Interrupted{};
    }
    if (task == 0) continue;
    const bool is_again = is_to_be_tried(folder, task, ++tries[task]);
    if (is_again) waiting.push_back(task);
    result.ran += is_published(folder, task) ? 1 : 0;
    result.failed += !is_again && !is_published(folder, task) ? 1 : 0;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    fmt::print(messages, "task {}: {}{} ({} of {}, {:.0f} s)\n", task,
               end_text(folder, task, status), is_again ? ", is tried again" : "",
               result.ran + result.failed, tasks.size(), taken.count());
    std::fflush(messages);
  }
  return result;
}

}  // namespace bess
