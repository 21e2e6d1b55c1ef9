// bess-notify: calls for help. A program of its own, outside the control process: it asks bess-edge
// and reports what is wrong by a command and MQTT. Killed, stuck or absent, it changes nothing for
// the controller.
#include <signal.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <string_view>
#include <thread>

#include "edge/companion/stop_signals.h"
#include "edge/notify/notifier.h"
#include "edge/notify/notify_settings.h"
#include "edge/notify/topics.h"
#include "edge/storage/instance_lock.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr const char* kHelp =
    R"(bess-notify: reports by a command and MQTT when a battery controller needs help

  bess-notify [--config FILE]            every [notify] every_s, until SIGTERM
  bess-notify [--config FILE] --once     one round, for a timer
  bess-notify [--config FILE] --test     one message to every channel that is configured
  bess-notify [--config FILE] --check    is [notify] right? Sends nothing

  --config FILE  the controller's settings; section [notify]; default /etc/bess/edge.toml
  --help         this text
  --version      the version

Each alarm is reported once, and its end once, also over restarts; what the command does not take is
tried again every round. It asks bess-edge and takes no lock of it: the controller does not know
that it exists. One bess-notify to one [notify] folder: a second one is refused; --test and --check
may run beside it.
Exit codes:
  0 done
  1 the settings are bad, another bess-notify runs, a test message was not taken
  2 the command line is bad
)";

std::int64_t now_utc_s() { return clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond; }

int print_check(const NotifySettings& settings) {
  const MqttSettings& mqtt = settings.mqtt;
  const std::string broker =
      mqtt.host + ":" + std::to_string(mqtt.port) + (mqtt.ca_file.empty() ? "" : " with TLS") +
      ", topics " + topic(settings.name, "...") + (mqtt.orders ? ", holds may be ordered" : "");
  std::printf("node       %s, every %d s, reported after %d s\n", settings.name.c_str(),
              settings.every_s, settings.after_s);
  std::printf("asks       %s status --config %s\n", settings.program.c_str(),
              settings.config_path.c_str());
  std::printf("command    %s\n", settings.command.empty() ? "none" : "configured");
  std::printf("mqtt       %s\n", mqtt.host.empty() ? "none" : broker.c_str());
  return 0;
}

/// Rounds begin at fixed times; one that is late is left out.
void watch(Notifier& notifier, std::int32_t every_s, const std::stop_token& stop) {
  auto next = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    notifier.run_round(now_utc_s());
    do next += std::chrono::seconds(every_s);
    while (next <= std::chrono::steady_clock::now());
    notifier.serve_until(next);
  }
}

/// Where the folder refuses a lock nothing is refused: reported twice is better than not at all.
bool is_alone(const NotifySettings& settings, InstanceLock& lock) {
  FileMessage error;
  make_folder(folder_of(settings.lock.c_str()).c_str());
  if (lock.take(settings.lock.c_str(), "[notify] folder", error)) return true;
  std::fprintf(stderr, "bess-notify: %s\n", error.c_str());
  return holder_of(settings.lock.c_str()) == 0;
}

int run(std::string_view task, const std::string& config_path) {
  NotifySettings settings;
  std::string error;
  if (!load_notify_settings(config_path, settings, error)) {
    std::fprintf(stderr, "bess-notify: %s\n", error.c_str());
    return 1;
  }
  if (task == "--check") return print_check(settings);
  const sigset_t stop_signals = block_stop_signals();
  if (task == "--test") return send_test(settings, now_utc_s()) ? 0 : 1;
  InstanceLock lock;
  if (!is_alone(settings, lock)) return 1;
  std::stop_source stop;
  std::thread([stop, stop_signals]() mutable {
    int ignored = 0;
    sigwait(&stop_signals, &ignored);
    stop.request_stop();
  }).detach();
  Notifier notifier(settings, stop.get_token());
  if (task == "--once") {
    notifier.run_round(now_utc_s());
    notifier.finish(std::chrono::minutes(2));  // a command's time, and as much again
    return 0;
  }
  watch(notifier, settings.every_s, stop.get_token());
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  std::string config_path = "/etc/bess/edge.toml";
  std::string_view task;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--help" || argument == "-h") {
      std::fputs(bess::kHelp, stdout);
      return 0;
    }
    if (argument == "--version") {
      std::puts("bess-notify " BESS_VERSION);
      return 0;
    }
    if (argument == "--once" || argument == "--test" || argument == "--check") {
      task = argument;
    } else if (argument == "--config" && i + 1 < argc) {
      config_path = argv[++i];
    } else {
      std::fprintf(stderr, "bess-notify: unknown option or missing value: %s (see --help)\n",
                   argv[i]);
      return 2;
    }
  }
  return bess::run(task, config_path);
}
