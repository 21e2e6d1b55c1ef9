// bess-edge without a command, or `run`: drives the battery. The composition root:
//   bess-prices --> PriceReader ------------+-> ControlLoop -> student -> SafetyGuard
//   battery ------> ModbusBattery ----------+         |                        |
//   meter, limits -> SiteLimits ------------+         |                        +-> ModbusBattery
//                                                     +-> EventLog (own thread), ServiceNotify
#include "edge/commands/check.h"
#include "edge/commands/command_list.h"
#include "edge/commands/self_test.h"
#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "edge/program/controller.h"
#include "edge/program/find_battery.h"
#include "edge/program/real_world.h"

namespace bess {
namespace {

struct RunGiven {
  bool check = false;
  bool self_test = false;
  bool dry_run = false;
  std::int64_t cycles = -1;  ///< -1 = until stopped
  std::string record_path;   ///< empty = nothing is recorded
};

using O = OptionsOf<RunGiven>;
constexpr CommandOption kOptions[] = {
    O::flag<&RunGiven::check>("--check"), O::flag<&RunGiven::self_test>("--self-test"),
    O::flag<&RunGiven::dry_run>("--dry-run"), O::count<&RunGiven::cycles>("--cycles"),
    O::text<&RunGiven::record_path>("--record")};

constexpr const char* kHelp =
    R"(bess-edge: drives a battery on the imbalance price, every two minutes

  bess-edge [--config FILE] [--dry-run] [--cycles N] [--record FILE]    run
  bess-edge [--config FILE] --check                     what would be done; writes nothing
  bess-edge [--config FILE] --self-test                 can this machine run the controller here?
(commands)

  --config FILE  settings in TOML; edge/bess-edge.toml documents every key; default
                 /etc/bess/edge.toml
  --check        check settings, map, student and sign check, print the registers that would be
                 written, read the battery and the newest price once, write nothing, exit
  --self-test    try student, signature, seal, clock, certificates, price server, storage
                 and battery once; a table, nothing is written to the battery
  --dry-run      run, but write nothing, whatever the file says (control = false does the same)
  --cycles N     stop cleanly after N cycles
  --record FILE  besides, write every request to the battery and its reply to FILE (see bess-edge
                 record --help): what bess-sim battery --replay plays again
  --help         this text; behind a command, more on that one
  --version      version and the student that is built in

Options may stand before the command or behind it. A run writes nothing to the battery unless the
file says control = true and `bess-edge commission` has found its sign right. One controller to
one battery: a second one is refused, also one that only reads (--check too), because many
batteries serve one connection. SIGTERM or Ctrl-C: 0 W is ordered, the battery is released, exit
0. SIGHUP: exit 0 and leave the order in force for the next start, which takes over; the battery's
own timer ends it if there is none.
Exit codes:
  0 done
  1 settings or battery are bad, the sign is not checked, the battery is in use, or was not
    released at the end; with --check also: no price, clock not set by NTP; with --self-test: a
    part fails
  2 the command line is bad

  bess-edge --config /etc/bess/edge.toml --check
  bess-edge --config /etc/bess/edge.toml --dry-run --cycles 5
)";

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

const EdgeCommand kRunCommand = {
    .name = "run",
    .usage = "[--config FILE] [--dry-run] [--cycles N] [--record FILE]",
    .does = "run",
    .help = kHelp,
    .options = kOptions,
    .run = run_with<RunGiven, run>};

}  // namespace bess
