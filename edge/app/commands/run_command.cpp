// Controller run, the composition root: bess-edge without a command.
//   bess-prices --> PriceReader ------------+-> ControlLoop -> student -> SafetyGuard
//   battery ------> ModbusBattery ----------+         |                        |
//   meter, limits -> SiteLimits ------------+         |                        +-> ModbusBattery
//                                                     +-> EventLog (own thread), ServiceNotify
#include "edge/app/commands/command.h"
#include "edge/app/program/controller.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/program/real_world.h"
#include "edge/core/control/policy.h"

namespace bess {
namespace {

struct RunCommandOptions {
  bool check = false;
  bool self_test = false;
  bool dry_run = false;
  std::int64_t cycles = -1;  ///< -1 = until stopped
  std::string record_path;   ///< empty = no recording
};

constexpr const char* kRunFooter =
    R"(Writes to the battery only with control = true and after bess-edge commission has passed.
Each battery has one controller: a second one is refused, also read-only or with --check, because
many batteries serve only one connection. SIGTERM or Ctrl-C: order 0 W, release the battery, exit 0.
SIGHUP (hand-over): exit 0 and leave the order in force for the next start; without a next start
the battery's dead-man timer ends it.
Exit codes:
  0 done
  1 settings or battery wrong, sign not checked, battery in use, or battery not released at the
    end; --check also: no price, clock not set by NTP; --self-test: a part failed
  2 command line error
Examples:
  bess-edge --config /etc/bess/edge.toml --check
  bess-edge --config /etc/bess/edge.toml --dry-run --cycles 5)";

/// Once per process: the objects are static, and the process stays sealed after the run.
int run_controller(const RunCommandOptions& options, const EdgeConfig& config) {
  static DeviceSession session;
  if (!session.begin(config)) return 1;
  static ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  static ModbusMeter meter(config.site.link, config.site.map, config.clock);
  static PriceReader prices({.path = prices_file(config), .model = student_outlook()},
                            config.clock);
  FileMessage error;
  if (!lock_state(config, session.locks, error)) return failed(error.c_str());
  static RealWorld world(
      config, {.clock = *session.clock, .battery = battery, .meter = meter, .prices = prices});
  if (!world.record_battery(options.record_path, error)) return failed(error.c_str());
  static Controller<RealWorld> controller(config, world);
  if (!controller.reach() || !controller.begin()) return 1;
  const bool is_released = controller.run(options.cycles);
  if (!world.finish_recording(error)) return failed(error.c_str());
  return is_released ? 0 : 1;
}

int run(const RunCommandOptions& options, SettingsFile& settings) {
  if (options.self_test) return run_self_test(settings.config, settings.path);
  if (options.dry_run) settings.config.control.control = false;
  return options.check ? run_check(settings.config, settings.path)
                       : run_controller(options, settings.config);
}

}  // namespace

void add_run(EdgeCommand root) {
  const auto options = std::make_shared<RunCommandOptions>();
  root.flag("--check", options->check,
            "check settings, map, student and sign check, print the encoded orders, read battery "
            "and newest price once, then exit; writes nothing to the battery");
  root.flag("--self-test", options->self_test,
            "test student, signature, heap seal, clock, certificates, price server, storage and "
            "battery once, then exit; writes nothing to the battery");
  root.flag("--dry-run", options->dry_run, "run read-only, as with control = false");
  root.option("--cycles", options->cycles, "stop after N control cycles; default: no limit")
      .value_name("N")
      .positive();
  root.option("--record", options->record_path,
              "record all Modbus traffic to FILE; replay with bess-sim battery --replay FILE")
      .value_name("FILE");
  root.footer(kRunFooter);
  root.set_action([options](SettingsFile& settings) { return run(*options, settings); });
}

}  // namespace bess
