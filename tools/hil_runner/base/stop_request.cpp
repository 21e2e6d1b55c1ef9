#include "tools/hil_runner/base/stop_request.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <thread>

#include "shared/host/command_line.h"

namespace bess {
namespace {

constexpr int kExitInterruptedTwice = 130;  // exit code of a shell for a program killed by Ctrl-C

std::atomic<bool> is_requested = false;

}  // namespace

void watch_for_stop() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, number);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int number = 0;
    while (sigwait(&signals, &number) == 0) {
      if (is_requested.exchange(true)) _exit(kExitInterruptedTwice);
    }
  }).detach();
}

void request_stop() { is_requested = true; }

void throw_if_stopped() {
  if (is_requested) throw Interrupted{};
}

AbortKey::AbortKey() : terminal_(open("/dev/tty", O_RDWR | O_NOCTTY | O_CLOEXEC)) {
  if (terminal_ < 0) return;
  tcgetattr(terminal_, &before_);
  termios by_key = before_;
  by_key.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  tcsetattr(terminal_, TCSANOW, &by_key);
}

AbortKey::~AbortKey() {
  if (terminal_ < 0) return;
  tcsetattr(terminal_, TCSANOW, &before_);
  close(terminal_);
}

bool AbortKey::is_pressed() const {
  pollfd key{.fd = terminal_, .events = POLLIN, .revents = 0};
  char letter = 0;
  return terminal_ >= 0 && poll(&key, 1, 0) > 0 && read(terminal_, &letter, 1) == 1 &&
         (letter == 'q' || letter == 'Q');
}

}  // namespace bess
