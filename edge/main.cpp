// bess-edge: the composition root. Parses the configuration, does what a command asks for, or builds the world and
// its controller once and runs it:
//   price server -> PriceFeed (own thread) -+
//                                           +-> ControlLoop -> student -> SafetyGuard -> ModbusBattery
//   battery ------> ModbusBattery ----------+         |
//   meter, limits -> SiteLimits ------------+         |
//                                                     +-> EventLog (own thread), ServiceNotify
#include "edge/commands/clear_command.h"
#include "edge/commands/command_line.h"
#include "edge/commands/commission_command.h"
#include "edge/commands/history_command.h"
#include "edge/commands/hold_command.h"
#include "edge/commands/limit_command.h"
#include "edge/commands/log_command.h"
#include "edge/commands/map_check_command.h"
#include "edge/commands/record_command.h"
#include "edge/commands/release_command.h"
#include "edge/commands/self_test.h"
#include "edge/commands/signature_command.h"
#include "edge/commands/site_check.h"
#include "edge/commands/status_command.h"
#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/controller.h"
#include "edge/program/real_world.h"
#include "edge/program/release_on_failed_check.h"
#include "edge/program/startup.h"
#include "edge/storage/run_locks.h"

namespace bess {
namespace {

int fail(const char* message) {
  report(JournalLevel::kError, "%s", message);
  return 1;
}

int run_controller(const CommandLine& command_line, const EdgeConfig& config) {
  if (!check_student() || !prepare_memory()) return 1;
  FileMessage error;
  static RunLocks locks;
  if (!lock_battery(config, locks, error)) return fail(error.c_str());
  prepare_process();
  static EdgeClock clock(config.clock, config.require_synchronised_clock);
  if (command_line.command == SubCommand::kRecord) {
    return run_record_command(command_line, config, clock);
  }
  static ModbusBattery battery(config.link, config.map, config.clock);
  static ModbusMeter meter(config.site.link, config.site.map, config.clock);
  if (command_line.command == SubCommand::kCommission) {
    if (command_line.yes) release_if_a_check_fails(battery);
    return run_commission_command(command_line, config, battery, meter, clock);
  }
  if (command_line.command == SubCommand::kRelease) {
    return run_release_command(command_line, config, battery, clock);
  }
  static PriceFeed prices(config.price, config.clock);
  if (command_line.command == SubCommand::kCheck) {
    const bool is_well = report_check(config, battery, prices, clock);
    return report_site(config, battery, meter) && is_well ? 0 : 1;
  }
  if (!lock_state(config, locks, error)) return fail(error.c_str());
  static RealWorld world(config,
                         {.clock = clock, .battery = battery, .meter = meter, .prices = prices});
  if (!world.record_battery(command_line.record_path, error)) return fail(error.c_str());
  static Controller<RealWorld> controller(config, world);
  if (!controller.reach() || !controller.begin()) return 1;
  const bool is_released = controller.run(command_line.cycles);
  if (!world.finish_recording(error)) return fail(error.c_str());
  return is_released ? 0 : 1;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  using namespace bess;
  CommandLine command_line;
  const CommandLineResult result = parse_command_line(argc, argv, command_line);
  if (result != CommandLineResult::kGo) return result == CommandLineResult::kExitOk ? 0 : 2;
  if (command_line.command == SubCommand::kSignature) return run_signature_command();
  if (command_line.command == SubCommand::kMapCheck && !command_line.map_path.empty()) {
    return run_map_check_command(command_line, nullptr);
  }
  if (command_line.command == SubCommand::kHistory) return run_history_command(command_line);
  static EdgeConfig config;
  std::string error;
  if (!load_edge_config(command_line.config_path, config, error)) return fail(error.c_str());
  if (command_line.command == SubCommand::kStatus) return run_status_command(command_line, config);
  if (command_line.command == SubCommand::kClear) return run_clear_command(command_line, config);
  if (command_line.command == SubCommand::kLog) return run_log_command(command_line, config);
  if (command_line.command == SubCommand::kHold) return run_hold_command(command_line, config);
  if (command_line.command == SubCommand::kLimit) return run_limit_command(command_line, config);
  if (command_line.command == SubCommand::kMapCheck) {
    return run_map_check_command(command_line, &config);
  }
  if (command_line.command == SubCommand::kSelfTest) return run_self_test(config);
  if (command_line.dry_run) config.control.control = false;
  return run_controller(command_line, config);
}
