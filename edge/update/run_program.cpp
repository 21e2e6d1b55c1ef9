#include "edge/update/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "shared/host/text.h"

namespace bess {
namespace {

constexpr std::size_t kOutputBytesMax = std::size_t{1} << 20;

std::int64_t monotonic_ms() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000 + now.tv_nsec / 1'000'000;
}

/// Into `text`; false at the end of the pipe.
bool drain(int fd, std::string& text) {
  char buffer[4'096];
  const ssize_t size = read(fd, buffer, sizeof buffer);
  if (size > 0 && text.size() < kOutputBytesMax)
    text.append(buffer, static_cast<std::size_t>(size));
  return size > 0;
}

/// Reads both until they end; false at the deadline.
bool collect(int (&fds)[2], std::string* (&texts)[2], std::int64_t deadline_ms) {
  pollfd waited[2] = {{fds[0], POLLIN, 0}, {fds[1], POLLIN, 0}};
  while (waited[0].fd >= 0 || waited[1].fd >= 0) {
    const std::int64_t left_ms = deadline_ms - monotonic_ms();
    if (left_ms <= 0) return false;
    if (poll(waited, 2, static_cast<int>(left_ms)) < 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (waited[i].revents != 0 && !drain(waited[i].fd, *texts[i])) waited[i].fd = -1;
    }
  }
  return true;
}

int exit_code_of(pid_t pid, bool is_in_time) {
  if (!is_in_time) kill(pid, SIGKILL);
  int status = 0;
  waitpid(pid, &status, 0);
  if (!is_in_time) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

std::string ProgramRun::complaint() const {
  std::string_view rest = errors;
  std::string last;
  while (!rest.empty()) {
    const std::string line = one_line(take_line(rest), 300);
    if (!line.empty()) last = line;
  }
  if (!last.empty()) return last;
  return exit_code < 0 ? "it did not start, or did not end in time" : "it says nothing";
}

ProgramRun run_program(std::vector<std::string> arguments, std::int64_t timeout_s) {
  ProgramRun run;
  int out[2];
  int err[2];
  if (pipe2(out, O_CLOEXEC) != 0) return run;
  if (pipe2(err, O_CLOEXEC) != 0) {
    close(out[0]);
    close(out[1]);
    return run;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, err[1], STDERR_FILENO);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t pid = -1;
  const bool is_started = posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);
  if (is_started) {
    int fds[2] = {out[0], err[0]};
    std::string* texts[2] = {&run.output, &run.errors};
    run.exit_code = exit_code_of(pid, collect(fds, texts, monotonic_ms() + timeout_s * 1'000));
  }
  close(out[0]);
  close(err[0]);
  return run;
}

}  // namespace bess
