// bess-edge: the composition root. Parses the configuration, builds every object once, and runs the
// loop:
//   price server -> PriceFeed (own thread) -+
//                                           +-> ControlLoop -> student -> SafetyGuard -> ModbusBattery
//   battery ------> ModbusBattery ----------+         |
//                                                     +-> EventLog (own thread), ServiceNotify
#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/command_line.h"
#include "edge/program/commission_command.h"
#include "edge/program/commission_file.h"
#include "edge/program/log_command.h"
#include "edge/program/run_locks.h"
#include "edge/program/startup.h"
#include "edge/program/status_command.h"
#include "edge/program/supervised_loop.h"
#include "shared/check.h"

namespace bess {
namespace {

using Loop = ControlLoop<ModbusBattery, PriceFeed, EdgeClock>;

ModbusBattery* battery_of_check_handler = nullptr;

/// A broken promise of the program itself: 0 W and release before it ends.
void release_after_failed_check(const char*, const char*, int) {
  if (battery_of_check_handler == nullptr) return;
  static_cast<void>(battery_of_check_handler->order({.duration_s = 60}));
  static_cast<void>(battery_of_check_handler->release());
}

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
  static ModbusBattery battery(config.link, config.map, config.clock);
  if (command_line.command == SubCommand::kCommission) {
    return run_commission_command(command_line, config, battery, clock);
  }
  static PriceFeed prices(config.price, config.clock);
  if (command_line.command == SubCommand::kCheck) {
    return report_check(config, battery, prices, clock) ? 0 : 1;
  }
  static ServiceNotify notify;
  notify.extend_start(config.start_timeout_s + 60);
  static EventLog log;
  if (!lock_state(config, locks, error)) return fail(error.c_str());
  if (!log.open(config.log, identity_of_run(config), error)) return fail(error.c_str());
  if (!reach_battery(config, battery, clock)) return 1;
  std::string refusal;
  if (config.control.control && !is_commissioned(config, refusal)) return fail(refusal.c_str());
  greet_price_server(config, prices);
  write_journal_line(JournalLevel::kNotice,
                     config.control.control ? "started: in control" : "started: read-only");
  if (config.control.control) {
    battery_of_check_handler = &battery;
    check_handler() = release_after_failed_check;
  }
  static Loop loop(config.control, battery, prices, clock);
  CycleRecord before;
  if (log.newest(before)) {
    loop.take_over({.throughput = before.throughput});
    battery.restore_flash_writes(before.counters.flash_day, before.counters.flash_writes_today);
  }
  notify.ready();
  run_supervised(loop, command_line.cycles, clock, log, notify, config.control.control);
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  using namespace bess;
  CommandLine command_line;
  const CommandLineResult result = parse_command_line(argc, argv, command_line);
  if (result != CommandLineResult::kGo) return result == CommandLineResult::kExitOk ? 0 : 2;
  static EdgeConfig config;
  std::string error;
  if (!load_edge_config(command_line.config_path, config, error)) return fail(error.c_str());
  if (command_line.command == SubCommand::kStatus) return run_status_command(command_line, config);
  if (command_line.command == SubCommand::kLog) return run_log_command(command_line, config);
  if (command_line.dry_run) config.control.control = false;
  return run_controller(command_line, config);
}
