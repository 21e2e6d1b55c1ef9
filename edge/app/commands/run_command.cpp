// bess-edge without a command, or `run`: drives the battery. The composition root:
//   bess-prices --> PriceReader ------------+-> ControlLoop -> student -> SafetyGuard
//   battery ------> ModbusBattery ----------+         |                        |
//   meter, limits -> SiteLimits ------------+         |                        +-> ModbusBattery
//                                                     +-> EventLog (own thread), ServiceNotify
#include "edge/app/commands/check.h"
#include "edge/app/commands/command.h"
#include "edge/app/commands/self_test.h"
#include "edge/app/program/controller.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/program/real_world.h"
#include "edge/core/control/policy.h"
#include "edge/records/log/journal.h"

namespace bess {
namespace {

struct RunGiven {
  bool check = false;
  bool self_test = false;
  bool dry_run = false;
  std::int64_t cycles = -1;  ///< -1 = until stopped
  std::string record_path;   ///< empty = nothing is recorded
};

constexpr const char* kFooter =
    R"(A run writes nothing to the battery unless control = true and `bess-edge commission` has
found its sign right. One controller to one battery: a second one is refused, also one that only
reads (--check too), because many batteries serve one connection. SIGTERM or Ctrl-C: 0 W is ordered,
the battery is released, exit 0. SIGHUP: exit 0 and leave the order in force for the next start,
which takes over; the battery's own timer ends it if there is none.
Exit codes:
  0 done
  1 settings or battery are wrong, the sign is not checked, the battery is in use, or was not
    released at the end; with --check also: no price, clock not set by NTP; with --self-test: a
    part fails
  2 the command line is wrong
Examples:
  bess-edge --config /etc/bess/edge.toml --check
  bess-edge --config /etc/bess/edge.toml --dry-run --cycles 5)";

int fail(const FileMessage& error) {
  report(JournalLevel::kError, "%s", error.c_str());
  return 1;
}

/// Once in a process: what lives as long as it is static, and the end of a run leaves it sealed.
int run_controller(const RunGiven& given, const EdgeConfig& config) {
  static DeviceSession session;
  if (!session.begin(config)) return 1;
  static ModbusBattery battery(config.battery.link, config.battery.map, config.clock);
  static ModbusMeter meter(config.site.link, config.site.map, config.clock);
  static PriceReader prices({.path = prices_file(config), .model = student_outlook()},
                            config.clock);
  FileMessage error;
  if (!lock_state(config, session.locks(), error)) return fail(error);
  static RealWorld world(
      config, {.clock = session.clock(), .battery = battery, .meter = meter, .prices = prices});
  if (!world.record_battery(given.record_path, error)) return fail(error);
  static Controller<RealWorld> controller(config, world);
  if (!controller.reach() || !controller.begin()) return 1;
  const bool is_released = controller.run(given.cycles);
  if (!world.finish_recording(error)) return fail(error);
  return is_released ? 0 : 1;
}

int run(const RunGiven& given, SettingsFile& settings) {
  if (given.self_test) return run_self_test(settings.config, settings.path);
  if (given.dry_run) settings.config.control.control = false;
  return given.check ? run_check(settings.config, settings.path)
                     : run_controller(given, settings.config);
}

}  // namespace

void add_run(EdgeCommand root) {
  const auto given = std::make_shared<RunGiven>();
  root.flag("--check", given->check,
            "check settings, map, student and sign check, print the registers that would be "
            "written, read battery and newest price once, write nothing, exit");
  root.flag("--self-test", given->self_test,
            "try student, signature, seal, clock, certificates, price server, storage and battery "
            "once; a table, nothing is written to the battery");
  root.flag("--dry-run", given->dry_run,
            "run, but write nothing to the battery, as control = false does");
  root.option("--cycles", given->cycles, "stop cleanly after N cycles").value_name("N").positive();
  root.option("--record", given->record_path,
              "also write every request to the battery and its reply to FILE (bess-edge record): "
              "bess-sim battery --replay plays it again")
      .value_name("FILE");
  root.footer(kFooter);
  root.does([given](SettingsFile& settings) { return run(*given, settings); });
}

}  // namespace bess
