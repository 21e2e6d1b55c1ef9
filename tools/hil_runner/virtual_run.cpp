#include "tools/hil_runner/virtual_run.h"

#include <pthread.h>
#include <signal.h>

#include <deque>

#include "edge/battery/modbus_battery.h"
#include "edge/control/control_loop.h"
#include "edge/control/level_start.h"
#include "edge/control/policy.h"
#include "edge/program/edge_clock.h"
#include "edge/program/take_over.h"
#include "tools/hil_runner/virtual_bus.h"
#include "tools/hil_runner/virtual_prices.h"
#include "tools/hil_runner/virtual_time.h"

namespace bess {
namespace {

/// EdgeClock blocks the signals that end a program; this one may still be interrupted.
class KeptSignalMask {
 public:
  KeptSignalMask() { pthread_sigmask(SIG_SETMASK, nullptr, &mask_); }
  KeptSignalMask(const KeptSignalMask&) = delete;
  KeptSignalMask& operator=(const KeptSignalMask&) = delete;
  ~KeptSignalMask() { pthread_sigmask(SIG_SETMASK, &mask_, nullptr); }

 private:
  sigset_t mask_{};
};

LoggedCycle logged(const CycleRecord& record) {
  const BatteryMeasurement& m = record.measurement;
  return {.utc_s = record.utc_s,
          .mode = record.mode,
          .has_measurement = record.has_measurement,
          .soc_e4 = m.soc_e4,
          .has_price = record.price.has_row,
          .price_minute_utc_s = record.price.minute_utc_s,
          .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh,
          .has_student_action = record.has_student_action,
          .student_action = record.student_action,
          .context_class = record.context_class,
          .ordered_power_w = record.ordered_power_w,
          .battery_power_w = m.power_w,
          .reason = std::string(reason_name(record.reason)),
          .written = record.written};
}

/// What bess-edge keeps on its disk between two runs.
class EdgeState {
 public:
  void add(const CycleRecord& record) {
    records_.push_back(record);
    if (records_.size() > kRecordsMax) records_.pop_front();
  }
  [[nodiscard]] bool read_back(std::int64_t records, CycleRecord& record) const {
    const auto size = static_cast<std::int64_t>(records_.size());
    if (records >= size) return false;
    record = records_[static_cast<std::size_t>(size - 1 - records)];
    return true;
  }

 private:
  static constexpr std::size_t kRecordsMax = 720;  // a day: more than a start reads again
  std::deque<CycleRecord> records_;
};

class VirtualEdge {
 public:
  VirtualEdge(const EdgeConfig& config, VirtualPrices prices, SimulatedBattery& physics,
              VirtualTime& time, Weather weather)
      : config_(config),
        physics_(physics),
        time_(time),
        weather_(weather),
        clock_(config.clock, config.require_synchronised_clock),
        battery_(config.link, config.map, config.clock),
        prices_(prices),
        loop_(config.control, battery_, prices_, clock_) {}

  /// From its start to its end; the exit code.
  int run(EdgeState& state, Evidence& evidence) {
    if (!reach_battery()) return 1;
    take_over(state);
    CycleRecord record;
    while (loop_.run_cycle(record)) {
      keep(record, state, evidence);
      if (weather_ != nullptr)
        physics_.set_derating(weather_(time_.utc_ns() / kNanosecondsPerSecond));
    }
    loop_.finish_step();
    if (!clock_.hand_over_requested() || !loop_.hand_over(record)) loop_.stop(record);
    keep(record, state, evidence);
    return record.battery_status == Status::kOk ? 0 : 1;
  }

 private:
  static void keep(const CycleRecord& record, EdgeState& state, Evidence& evidence) {
    state.add(record);
    evidence.log.push_back(logged(record));
  }

  bool reach_battery() {
    const std::int64_t end_ns =
        clock_.monotonic_ns() + config_.start_timeout_s * kNanosecondsPerSecond;
    IdentityFailure failure;
    while (battery_.check_identity(failure) != Status::kOk) {
      if (clock_.monotonic_ns() >= end_ns) return config_.start_without_battery;
      clock_.pause_ns(kNanosecondsPerSecond);
    }
    return true;
  }

  void take_over(const EdgeState& state) {
    CycleRecord before;
    if (state.read_back(0, before)) {
      battery_.restore_flash_writes(before.counters.flash_day, before.counters.flash_writes_today);
    }
    const LevelStart start = find_start_level(
        student_context().kind, before.price_level, clock_.now_utc_ns() / kNanosecondsPerSecond,
        config_.level_start_centi_eur_per_mwh, [] { return PriceLevel{}; });
    recall_cycles(state, clock_.now_utc_ns() / kNanosecondsPerSecond, loop_);
    loop_.take_over(take_over_of(before, before.is_tripped ? before.trip : Trip{}, start.level));
  }

  const EdgeConfig& config_;
  SimulatedBattery& physics_;
  VirtualTime& time_;
  Weather weather_;
  EdgeClock clock_;
  ModbusBattery battery_;
  VirtualPrices prices_;
  ControlLoop<ModbusBattery, VirtualPrices, EdgeClock> loop_;
};

}  // namespace

Evidence run_virtual(const Scenario& scenario, const MinuteSeries& prices, const EdgeConfig& config,
                     Weather weather) {
  const KeptSignalMask mask;
  VirtualTime time(scenario);
  SimulatedBattery battery(scenario.battery.physics, scenario.battery.soc_frac, time.utc_ns());
  VirtualBus bus(scenario, config.map, battery, time);
  const MarketView market(prices, scenario.prices.latency_s);
  MarketFaultPlan faults({.fault = scenario.price_fault.fault,
                          .every = scenario.price_fault.every,
                          .from_s = 60 * scenario.price_fault.span.from_min,
                          .to_s = 60 * scenario.price_fault.span.to_min});
  Evidence evidence;
  EdgeState state;
  do {
    try {
      VirtualEdge edge(config, VirtualPrices(config.price, market, faults, scenario, time), battery,
                       time, weather);
      evidence.edge_exit_code = edge.run(state, evidence);
    } catch (const EdgeKilled&) {
      evidence.edge_exit_code = 128 + SIGKILL;
    }
  } while (time.advance_to_next_start());
  bus.device().advance(time.utc_ns());
  evidence.orders = battery.dispatch_events();
  evidence.minutes = battery.record();
  evidence.is_alive_at_end = true;
  return evidence;
}

}  // namespace bess
