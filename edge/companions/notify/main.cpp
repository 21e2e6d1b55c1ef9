// Alert program bess-notify, outside the control process: it reads bess-edge status and reports
// alerts by a command and MQTT. Killed, hanging or absent, it does not affect the controller.
#include <chrono>
#include <cstdio>
#include <string>

#include "edge/app/storage/instance_lock.h"
#include "edge/companions/common/stop_signals.h"
#include "edge/companions/notify/notifier.h"
#include "edge/companions/notify/notify_settings.h"
#include "edge/companions/notify/topics.h"
#include "shared/host/command_line.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr const char* kFooter =
    R"(Reports each alert once and its end once, also over restarts. Messages that the command does
not accept stay in a retry queue and are repeated every round. Reads bess-edge status without a lock
and does not disturb the controller. Each [notify] folder has one bess-notify: a second one is
refused, except with --test or --check.
Exit codes:
  0 done
  1 settings wrong, another bess-notify runs, or a test message not delivered
  2 command line error)";

struct Options {
  std::string config_path = "/etc/bess/edge.toml";
  bool once = false;
  bool test = false;
  bool check = false;
};

std::int64_t now_utc_s() { return clock_ns(CLOCK_REALTIME) / kNanosecondsPerSecond; }

int print_check(const NotifySettings& settings) {
  const MqttSettings& mqtt = settings.mqtt;
  const std::string broker = mqtt.host + ":" + std::to_string(mqtt.port) +
                             (mqtt.ca_file.empty() ? "" : " with TLS") + ", topics " +
                             topic(settings.name, "...") + (mqtt.orders ? ", holds allowed" : "");
  std::printf("node       %s, every %d s, reported after %d s\n", settings.name.c_str(),
              settings.every_s, settings.after_s);
  std::printf("asks       %s status --config %s\n", settings.program.c_str(),
              settings.config_path.c_str());
  std::printf("command    %s\n", settings.command.empty() ? "none" : "configured");
  std::printf("mqtt       %s\n", mqtt.host.empty() ? "none" : broker.c_str());
  return 0;
}

/// Rounds start at fixed times; a late round is skipped.
void watch(Notifier& notifier, std::int32_t every_s, const std::stop_token& stop) {
  auto next = std::chrono::steady_clock::now();
  while (!stop.stop_requested()) {
    notifier.run_round(now_utc_s());
    do next += std::chrono::seconds(every_s);
    while (next <= std::chrono::steady_clock::now());
    notifier.serve_until(next);
  }
}

/// Without a lock for other causes than another bess-notify it runs: two reports are better than
/// none.
bool is_alone(const NotifySettings& settings, InstanceLock& lock) {
  FileMessage error;
  make_folder(folder_of(settings.lock.c_str()).c_str());
  if (lock.take(settings.lock.c_str(), "[notify] folder", error)) return true;
  std::fprintf(stderr, "bess-notify: %s\n", error.c_str());
  return lock_owner_pid(settings.lock.c_str()) == 0;
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
  set_market_time_zone();
  const StopSignals stop_signals([&] { stop.request_stop(); });
  if (options.test) return send_test(settings, now_utc_s()) ? 0 : 1;
  InstanceLock lock;
  if (!is_alone(settings, lock)) return 1;
  Notifier notifier(settings, stop.get_token());
  if (options.once) {
    notifier.run_round(now_utc_s());
    notifier.finish(std::chrono::minutes(2));  // twice the time limit of the command
    return 0;
  }
  watch(notifier, settings.every_s, stop.get_token());
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  bess::CommandLine line("bess-notify",
                         "report alerts of a battery controller by a command and MQTT",
                         "bess-notify " BESS_VERSION);
  bess::Options options;
  bess::ProgramCommand root = line.root();
  root.option("--config", options.config_path, "settings of the controller, section [notify]")
      .with_default();
  root.flag("--once", options.once,
            "run one round, for a timer; default: a round every [notify] every_s");
  root.flag("--test", options.test, "send one test message to every configured channel")
      .excludes("--once");
  root.flag("--check", options.check, "check [notify], send nothing")
      .excludes("--once")
      .excludes("--test");
  root.footer(bess::kFooter);
  root.exits_with([&] { return bess::run(options); });
  return line.run(argc, argv);
}
