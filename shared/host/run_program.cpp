#include "shared/host/run_program.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "shared/host/text.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr std::size_t kOutputBytesMax = 1 << 20;

/// Pipe, not inherited by other programs.
struct Pipe {
  explicit Pipe(bool is_wanted = true) {
    if (!is_wanted || pipe2(ends, O_CLOEXEC) != 0) ends[0] = ends[1] = -1;
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
  int ends[2];
};

/// The program does not inherit blocked or ignored signals, and has its own process group, so that
/// its children end with it.
pid_t spawn(const std::vector<std::string>& arguments, const Pipe& in, const Pipe& out,
            const Pipe& errors) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.ends[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.ends[1], STDOUT_FILENO);
  if (errors.ends[1] >= 0) {
    posix_spawn_file_actions_adddup2(&actions, errors.ends[1], STDERR_FILENO);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigset_t pipe_signal;
  sigemptyset(&none);
  sigemptyset(&pipe_signal);
  sigaddset(&pipe_signal, SIGPIPE);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &pipe_signal);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes,
                           POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  pid_t pid = -1;
  errno = posix_spawnp(&pid, argv[0], &actions, &attributes, argv.data(), environ);
  const int spawn_errno = errno;
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  errno = spawn_errno;
  return errno == 0 ? pid : -1;
}

/// Deadline and stop request of a program.
struct Timeouts {
  std::int64_t deadline_ns;
  const std::stop_token& stop;

  [[nodiscard]] int left_ms() const {
    const std::int64_t left_ms = (deadline_ns - clock_ns(CLOCK_MONOTONIC)) / 1'000'000;
    return stop.stop_requested() || left_ms <= 0 ? 0 : static_cast<int>(left_ms);
  }
};

/// Reads one pipe into `text`; closes it at its end.
void take_output(Pipe& pipe, std::string& text) {
  char buffer[4'096];
  const ssize_t size = read(pipe.ends[0], buffer, sizeof buffer);
  if (size == 0) pipe.close_end(0);
  if (size > 0) text.append(buffer, static_cast<std::size_t>(size));
}

void give_input(Pipe& in, std::string_view& input) {
  const ssize_t written = write(in.ends[1], input.data(), input.size());
  if (written > 0) input.remove_prefix(static_cast<std::size_t>(written));
  if ((written < 0 && errno != EAGAIN) || input.empty()) in.close_end(1);
}

/// Writes and reads until the program closes its outputs; false after the deadline or with too much
/// output.
bool exchange(Pipe& in, Pipe& out, Pipe& errors, std::string_view input, const Timeouts& timeouts,
              ProgramResult& result) {
  constexpr int kLookMs = 100;
  fcntl(in.ends[1], F_SETFL, O_NONBLOCK);
  if (input.empty()) in.close_end(1);
  while (out.ends[0] >= 0 || errors.ends[0] >= 0) {
    const int left_ms = timeouts.left_ms();
    if (left_ms == 0) return false;
    pollfd waiting[] = {{.fd = out.ends[0], .events = POLLIN, .revents = 0},
                        {.fd = errors.ends[0], .events = POLLIN, .revents = 0},
                        {.fd = in.ends[1], .events = POLLOUT, .revents = 0}};
    if (poll(waiting, 3, std::min(left_ms, kLookMs)) < 0) {
      if (errno != EINTR) return false;
      continue;
    }
    if (waiting[2].revents != 0) give_input(in, input);
    if (waiting[0].revents != 0) take_output(out, result.output);
    if (waiting[1].revents != 0) take_output(errors, result.errors);
    if (result.output.size() + result.errors.size() >= kOutputBytesMax) return false;
  }
  return true;
}

/// Waits for the end, which may be later than that of the output. False after the deadline.
bool reap(pid_t pid, const Timeouts& timeouts, int& status) {
  constexpr std::int64_t kSliceNs = 2'000'000;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (timeouts.left_ms() == 0) return false;
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + kSliceNs);
  }
  return true;
}

ProgramResult run(const std::vector<std::string>& arguments, std::string_view input,
                  bool hears_errors, const Timeouts& timeouts) {
  ProgramResult result;
  Pipe in;
  Pipe out;
  Pipe errors(hears_errors);
  const bool has_pipes =
      in.ends[0] >= 0 && out.ends[0] >= 0 && (!hears_errors || errors.ends[0] >= 0);
  const pid_t pid = has_pipes ? spawn(arguments, in, out, errors) : -1;
  if (pid < 0) {
    result.trouble = arguments[0] + " cannot be started: " + std::strerror(errno);
    return result;
  }
  in.close_end(0);
  out.close_end(1);
  errors.close_end(1);
  int status = 0;
  const bool in_time =
      exchange(in, out, errors, input, timeouts, result) && reap(pid, timeouts, status);
  if (!in_time) {
    kill(-pid, SIGKILL);
    waitpid(pid, &status, 0);
    result.trouble = arguments[0] + " did not end in time";
    return result;
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace

std::string ProgramResult::complaint() const {
  if (!trouble.empty()) return trouble;
  std::string_view rest = errors;
  std::string last;
  while (!rest.empty()) {
    const std::string line = one_line(take_line(rest), 300);
    if (!line.empty()) last = line;
  }
  return last.empty() ? "no error output" : last;
}

ProgramResult run_program(const std::vector<std::string>& arguments, std::string_view input,
                          int time_ms_max, const std::stop_token& stop) {
  return run(arguments, input, false,
             {clock_ns(CLOCK_MONOTONIC) + time_ms_max * 1'000'000LL, stop});
}

ProgramResult run_and_capture(const std::vector<std::string>& arguments, std::int64_t timeout_s) {
  const std::stop_token never;
  return run(arguments, "", true,
             {clock_ns(CLOCK_MONOTONIC) + timeout_s * kNanosecondsPerSecond, never});
}

}  // namespace bess
