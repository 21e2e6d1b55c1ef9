// bess-notify: calls for help. A program of its own, outside the control process: it asks
// `bess-edge status` and reads the decision log, and tells what is wrong by a command and MQTT.
// Killed, stuck or absent, it changes nothing for the controller.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>

#include "edge/companion/stop_signals.h"
#include "edge/notify/journal_line.h"
#include "edge/notify/notifier.h"
#include "edge/notify/notify_lock.h"
#include "edge/notify/notify_settings.h"
#include "shared/file_descriptor.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr const char* kHelp =
    R"(bess-notify: tells by a command and MQTT when a battery controller needs help

  bess-notify [--config FILE]            every [notify] every_s, until SIGTERM
  bess-notify [--config FILE] --once     one round, for a timer
  bess-notify [--config FILE] --test     one message by every way that is configured
  bess-notify [--config FILE] --check    is [notify] right? Sends nothing

  --config FILE  the controller's settings; section [notify]; default /etc/bess/edge.toml
  --help         this text
  --version      the version

Each alarm is told once, and its end once, also over restarts. Every way has a queue and a thread
of its own: one that hangs holds up neither the others nor the next look. It reads what bess-edge
publishes and takes no lock of it: the controller does not know that it exists.
One bess-notify to one [notify] folder: a second one is refused; --test and --check may run beside
it.
Exit codes:
  0 done
  1 the settings are bad, another bess-notify runs, a test message was not taken
  2 the command line is bad
)";

enum class Task { kWatch, kOnce, kTest, kCheck };

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  Task task = Task::kWatch;
};

/// -1 to go on; else the exit code.
int parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--help" || argument == "-h") return std::fputs(kHelp, stdout), 0;
    if (argument == "--version") return std::printf("bess-notify %s\n", BESS_VERSION), 0;
    if (argument == "--once")
      options.task = Task::kOnce;
    else if (argument == "--test")
      options.task = Task::kTest;
    else if (argument == "--check")
      options.task = Task::kCheck;
    else if (argument == "--config" && i + 1 < argc)
      options.config_path = argv[++i];
    else {
      std::fprintf(stderr, "bess-notify: unknown option or missing value: %s (see --help)\n",
                   argv[i]);
      return 2;
    }
  }
  return -1;
}

std::int64_t now_utc_s() { return clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond; }

void print_check(const NotifySettings& settings) {
  std::printf("node       %s, every %d s, told after %d s\n", settings.name.c_str(),
              settings.every_s, settings.after_s);
  std::printf("asks       %s status --config %s\n", settings.program.c_str(),
              settings.config_path.c_str());
  std::printf("command    %s\n", settings.command.empty() ? "none" : "configured");
  if (settings.mqtt.host.empty()) {
    std::printf("mqtt       none\n");
  } else {
    std::printf("mqtt       %s:%d%s, topics bess/v1/%s/...%s\n", settings.mqtt.host.c_str(),
                settings.mqtt.port, settings.mqtt.ca_file.empty() ? "" : " with TLS",
                settings.name.c_str(), settings.mqtt.orders ? ", holds may be ordered" : "");
  }
}

/// Until an instant of the monotonic clock; false when it is to end before.
bool wait_until(std::int64_t until_ns, int stop_fd, Notifier& notifier) {
  pollfd waiting[] = {{.fd = stop_fd, .events = POLLIN, .revents = 0},
                      {.fd = notifier.bell(), .events = POLLIN, .revents = 0}};
  while (true) {
    const std::int64_t left_ns = until_ns - clock_ns(CLOCK_MONOTONIC);
    if (left_ns <= 0) return true;
    if (poll(waiting, 2, static_cast<int>(left_ns / 1'000'000 + 1)) <= 0) continue;
    if (waiting[0].revents != 0) return false;
    if (waiting[1].revents != 0) {
      notifier.keep();
      notifier.follow_orders();
    }
  }
}

/// Rounds begin at fixed times, whatever the ways are at. One that is late is left out.
void watch(Notifier& notifier, std::int32_t every_s, const sigset_t& stop_signals) {
  const FileDescriptor stop(signalfd(-1, &stop_signals, SFD_CLOEXEC | SFD_NONBLOCK));
  std::int64_t next_ns = clock_ns(CLOCK_MONOTONIC);
  do {
    notifier.run_round(now_utc_s());
    do next_ns += every_s * kNanosecondsPerSecond;
    while (next_ns <= clock_ns(CLOCK_MONOTONIC));
  } while (wait_until(next_ns, stop.get(), notifier));
}

int run_once(Notifier& notifier) {
  constexpr std::chrono::minutes kPatience(2);  // a command's time, and as much again
  notifier.run_round(now_utc_s());
  static_cast<void>(notifier.wait_for_channels(kPatience));
  return 0;
}

int run(const Options& options) {
  NotifySettings settings;
  std::string error;
  if (!load_notify_settings(options.config_path, settings, error)) {
    std::fprintf(stderr, "bess-notify: %s\n", error.c_str());
    return 1;
  }
  if (options.task == Task::kCheck) return print_check(settings), 0;
  if (!settings.has_channel()) {
    say(JournalLevel::kWarning,
        "[notify] names no way (command, mqtt_host): alarms stand in the journal "
        "alone");
  }
  const sigset_t stop_signals = block_stop_signals();
  set_market_time_zone();
  if (options.task == Task::kTest) {  // beside one that watches
    return Notifier(settings, MqttPresence::kVisits).send_test(now_utc_s()) ? 0 : 1;
  }
  NotifyLock lock;
  if (!lock.take(settings.lock, error)) {
    say(JournalLevel::kError, error);
    return 1;
  }
  Notifier notifier(settings);
  if (options.task == Task::kOnce) return run_once(notifier);
  say(JournalLevel::kNotice, "started");
  watch(notifier, settings.every_s, stop_signals);
  say(JournalLevel::kNotice, "stopped");
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::Options options;
  const int exit_code = bess::parse(argc, argv, options);
  return exit_code >= 0 ? exit_code : bess::run(options);
}
