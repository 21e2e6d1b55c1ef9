// bess-edge: the composition root. Parses the configuration, builds every object once, and runs the
// loop:
//   price server -> PriceFeed (own thread) -+
//                                           +-> ControlLoop -> student -> SafetyGuard -> ModbusBattery
//   battery ------> ModbusBattery ----------+         |
//   meter, limits -> SiteLimits ------------+         |
//                                                     +-> EventLog (own thread), ServiceNotify
#include <pthread.h>

#include <utility>

#include "edge/base/check.h"
#include "edge/battery/modbus_meter.h"
#include "edge/control/control_loop.h"
#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "edge/memory/heap_seal.h"
#include "edge/program/clear_command.h"
#include "edge/program/command_line.h"
#include "edge/program/commission_command.h"
#include "edge/program/commission_file.h"
#include "edge/program/exchange_recorder.h"
#include "edge/program/history_command.h"
#include "edge/program/hold_command.h"
#include "edge/program/hold_watch.h"
#include "edge/program/limit_command.h"
#include "edge/program/limit_file.h"
#include "edge/program/log_command.h"
#include "edge/program/map_check_command.h"
#include "edge/program/people_config.h"
#include "edge/program/published_status.h"
#include "edge/program/record_command.h"
#include "edge/program/release_command.h"
#include "edge/program/run_locks.h"
#include "edge/program/self_test.h"
#include "edge/program/signature_command.h"
#include "edge/program/site_check.h"
#include "edge/program/startup.h"
#include "edge/program/status_command.h"
#include "edge/program/supervised_loop.h"
#include "edge/program/take_over.h"

namespace bess {
namespace {

using Site = SiteLimits<ModbusMeter, LimitFile>;
using Loop = ControlLoop<ModbusBattery, PriceFeed, EdgeClock, Site>;

ModbusBattery* battery_of_check_handler = nullptr;
pthread_t control_thread;

/// A broken promise of the program itself: 0 W and release before it ends. Not from another thread,
/// which would talk into the control thread's requests: the watchdog ends the order then. Nor
/// twice, should the release be what broke.
void release_after_failed_check(const char*, const char*, int) {
  ModbusBattery* const battery = std::exchange(battery_of_check_handler, nullptr);
  if (battery == nullptr || pthread_equal(pthread_self(), control_thread) == 0) return;
  static_cast<void>(battery->order({.duration_s = 60}));
  static_cast<void>(battery->release());
}

int fail(const char* message) {
  report(JournalLevel::kError, "%s", message);
  return 1;
}

void release_if_a_check_fails(ModbusBattery& battery) {
  battery_of_check_handler = &battery;
  control_thread = pthread_self();
  check_handler() = release_after_failed_check;
}

/// With --record, from the first request on: a replay needs to be identified too.
bool record_battery(const CommandLine& command_line, const EdgeConfig& config,
                    ModbusBattery& battery, ExchangeRecorder& recorder, FileMessage& error) {
  if (command_line.record_path.empty()) return true;
  if (!recorder.start(command_line.record_path.c_str(), recording_head_of(config), config.map,
                      config.clock, error)) {
    return false;
  }
  battery.link().tell_exchanges(recorder.listener());
  return true;
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
  static ServiceNotify notify;
  notify.extend_start(config.start_timeout_s + 60);
  static EventLog log;
  if (!lock_state(config, locks, error)) return fail(error.c_str());
  static ExchangeRecorder recorder;
  if (!record_battery(command_line, config, battery, recorder, error)) return fail(error.c_str());
  // A run that is refused leaves the status of the run before as it is.
  if (!reach_battery(config, battery, clock)) return 1;
  std::string refusal;
  if (config.control.control && !is_commissioned(config, refusal)) return fail(refusal.c_str());
  const std::uint64_t published = published_log_number(config);
  if (!log.open(config.log, identity_of_run(config), error)) return fail(error.c_str());
  const Status greeting = greet_price_server(config, prices);
  write_journal_line(JournalLevel::kNotice,
                     config.control.control ? "started: in control" : "started: read-only");
  journal_thresholds(config);
  journal_transport(config);
  if (config.control.control) release_if_a_check_fails(battery);
  static LimitFile limits(config.site.limit_file.c_str());
  static Loop loop(config.control, battery, prices, clock,
                   Site(config.site.settings, &meter, &limits));
  if (student_context().kind == ContextKind::kLevel) {
    notify.extend_start(config.history.wait_s + 60);
  }
  const Recall recalled = recall_at_start(config, log, published);
  const BatteryCounters& counters = recalled.before.counters;
  battery.restore_flash_writes(counters.flash_day, counters.flash_writes_today);
  const PriceLevel level =
      level_at_start(config, recalled.before.price_level, greeting, prices, clock);
  recall_cycles(log, clock.now_utc_ns() / kNanosecondsPerSecond, loop);
  loop.take_over(take_over_of(recalled.before, recalled.trip, level));
  static HoldWatch people;
  people.start(hold_path(config).c_str(), clearance_paths(config), config.clock.scale);
  loop.follow_holds(people.mailbox());
  notify.ready();
  const bool is_released = run_supervised(loop, command_line.cycles, clock, log, notify, people);
  if (!recorder.finish(error)) return fail(error.c_str());
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
