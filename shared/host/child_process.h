// Child process: started with arguments, output read by lines, stopped by signal.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

namespace bess {

class ChildProcess {
 public:
  /// Standard output and error are merged.
  explicit ChildProcess(std::vector<std::string> arguments) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (posix_spawn(&pid_, argv[0], &actions, nullptr, argv.data(), environ) != 0) pid_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = fdopen(ends[0], "r");
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess() {
    if (pid_ > 0) kill(pid_, SIGKILL);
    wait();
    if (output_ != nullptr) fclose(output_);
  }

  /// Next line of output without line end; empty at the end.
  std::string read_line() {
    std::string line;
    for (int c = fgetc(output_); c != EOF && c != '\n'; c = fgetc(output_)) {
      line += static_cast<char>(c);
    }
    return line;
  }
  std::string read_all() {
    std::string text;
    for (int c = fgetc(output_); c != EOF; c = fgetc(output_)) text += static_cast<char>(c);
    return text;
  }
  [[nodiscard]] pid_t pid() const { return pid_; }
  /// False if the process has ended: pid -1 would mean all processes of this user.
  bool signal(int number) const { return pid_ > 0 && kill(pid_, number) == 0; }
  /// Does not wait.
  [[nodiscard]] bool has_ended() const {
    siginfo_t info{};
    return pid_ <= 0 ||
           (waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
            info.si_pid != 0);
  }
  /// Exit code, or 128 + signal.
  int wait() {
    if (pid_ > 0) {
      int status = 0;
      waitpid(pid_, &status, 0);
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      pid_ = -1;
    }
    return exit_code_;
  }

 private:
  pid_t pid_ = -1;
  FILE* output_ = nullptr;
  int exit_code_ = -1;
};

}  // namespace bess
