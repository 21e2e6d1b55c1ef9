// bess-notify: calls for help. A program of its own, outside the control process: it asks bess-edge
// and reports what is wrong by a command and MQTT. Killed, stuck or absent, it changes nothing for
// the controller.
#include <chrono>
#include <cstdio>
#include <string>

#include "edge/app/storage/instance_lock.h"
#include "edge/companions/common/stop_signals.h"
#include "edge/companions/notify/notifier.h"
#include "edge/companions/notify/notify_settings.h"
#include "edge/companions/notify/topics.h"
#include "shared/host/command_line.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr const char* kFooter =
    R"(Each alarm is reported once, and its end once, also over restarts; what the command does not
take is repeated every round. It asks bess-edge and takes no lock of it: the controller does not
know that it exists. One bess-notify to one [notify] folder: a second one is refused; --test and
--check may run beside it.
Exit codes:
  0 done
  1 the settings are wrong, another bess-notify runs, a test message was not taken
  2 the command line is wrong)";

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  bool once = false;
  bool test = false;
  bool check = false;
};

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

int run(const Options& options) {
  NotifySettings settings;
  std::string error;
  if (!load_notify_settings(options.config_path, settings, error)) {
    std::fprintf(stderr, "bess-notify: %s\n", error.c_str());
    return 1;
  }
  if (options.check) return print_check(settings);
  std::stop_source stop;
  const StopSignals stop_signals([&] { stop.request_stop(); });
  if (options.test) return send_test(settings, now_utc_s()) ? 0 : 1;
  InstanceLock lock;
  if (!is_alone(settings, lock)) return 1;
  Notifier notifier(settings, stop.get_token());
  if (options.once) {
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
  bess::CommandLine line("bess-notify",
                         "reports by a command and MQTT when a battery controller needs help",
                         "bess-notify " BESS_VERSION);
  bess::Options options;
  bess::ProgramCommand root = line.root();
  root.option("--config", options.config_path, "the controller's settings; section [notify]")
      .with_default()
      .value_name("FILE");
  root.flag("--once", options.once, "one round, for a timer; default: every [notify] every_s");
  root.flag("--test", options.test, "one message to every channel that is configured")
      .excludes("--once");
  root.flag("--check", options.check, "check [notify], send nothing")
      .excludes("--once")
      .excludes("--test");
  root.footer(bess::kFooter);
  root.exits_with([&] { return bess::run(options); });
  return line.run(argc, argv);
}
