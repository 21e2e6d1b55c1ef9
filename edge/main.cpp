// bess-edge: the composition root. Parses the configuration, builds every object once, and runs the
// loop:
//   price server -> PriceFeed (own thread) -+
//                                           +-> ControlLoop -> student -> SafetyGuard ->
//                                           ModbusBattery
//   battery ------> ModbusBattery ----------+         |
//                                                     +-> EventLog
//   exit 0 clean stop   1 settings, battery or price server are bad   2 the command line is bad
#include <signal.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/command_line.h"
#include "edge/edge_clock.h"
#include "edge/edge_config.h"
#include "edge/event_log.h"
#include "edge/heap_seal.h"
#include "edge/startup.h"
#include "shared/check.h"

namespace {

using Loop = bess::ControlLoop<bess::ModbusBattery, bess::PriceFeed, bess::EdgeClock>;

bess::ModbusBattery* battery_of_check_handler = nullptr;

/// A broken promise of the program itself: 0 W and release before it ends.
void release_after_failed_check(const char*, const char*, int) {
  if (battery_of_check_handler == nullptr) return;
  static_cast<void>(battery_of_check_handler->order({.duration_s = 60}));
  static_cast<void>(battery_of_check_handler->release());
}

/// Runs until a stop is requested or `cycles` are done; the last order keeps its whole step.
int run_loop(Loop& loop, std::int64_t cycles, bess::EdgeClock& clock, bess::EventLog& log) {
  bess::CycleRecord record{};
  const bess::HeapSeal seal;  // from here on this thread calls no allocator
  clock.wait_for_simulated_start();
  for (std::int64_t i = 0; i != cycles && loop.run_cycle(record); ++i) log.write(record);
  clock.sleep_until_utc_ns((record.utc_s + bess::kSecondsPerStep) * bess::kNanosecondsPerSecond);
  const bess::Status status = loop.stop(record);
  log.write(record);
  log.note(status == bess::Status::kOk
               ? "stopped: battery released"
               : "stopped: release failed, the battery's own timer ends it");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace bess;
  CommandLine command_line;
  switch (parse_command_line(argc, argv, command_line)) {
    case CommandLineResult::kExitOk:
      return 0;
    case CommandLineResult::kExitUsage:
      return 2;
    case CommandLineResult::kRun:
      break;
  }
  static EdgeConfig config;
  std::string error;
  if (!load_edge_config(command_line.config_path, config, error)) {
    std::fprintf(stderr, "bess-edge: %s\n", error.c_str());
    return 1;
  }
  if (command_line.dry_run) config.control.control = false;
  if (!check_student() || !prepare_memory()) return 1;

  set_market_time_zone();
  signal(SIGPIPE, SIG_IGN);           // whoever reads the log may go away, the battery must not
  prctl(PR_SET_TIMERSLACK, 1'000UL);  // ns; the default 50 us would be seen at high time scales
  static EdgeClock clock(config.clock, config.require_synchronised_clock);
  static ModbusBattery battery(config.link, config.map, config.clock);
  static PriceFeed prices(config.price, config.clock);
  if (command_line.check) return report_check(config, battery, prices) ? 0 : 1;

  static EventLog log;
  if (!log.open(config.log_csv.c_str())) {
    std::fprintf(stderr, "bess-edge: %s: cannot write the log here: %s\n", config.log_csv.c_str(),
                 std::strerror(errno));
    return 1;
  }
  if (!reach_battery(config, battery, clock)) return 1;
  greet_price_server(config, prices);
  log.note(config.control.control ? "started: in control" : "started: read-only");
  if (config.control.control) {
    battery_of_check_handler = &battery;
    check_handler() = release_after_failed_check;
  }
  static Loop loop(config.control, battery, prices, clock);
  return run_loop(loop, command_line.cycles, clock, log);
}
