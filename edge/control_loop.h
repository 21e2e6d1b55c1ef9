// One cycle of the controller: read the battery, wait for the newest price, decide, guard, order,
// record. A template over battery, price source and clock, so that the very same code runs against
// Modbus and HTTP, against the battery model in tests, and in simulated time; nothing is virtual,
// nothing allocates.
//
//   Battery      Status read(BatteryMeasurement&);  Status order(const PowerOrder&);  Status
//   release(); PriceSource  void request(minute_utc_s, deadline_monotonic_ns);
//                bool wait(until_monotonic_ns);  PriceReport latest();
//   Clock        now_utc_ns(), monotonic_ns(), monotonic_ns_at(utc_ns), sleep_until_utc_ns(utc_ns),
//                stop_requested(), is_synchronised()
//
// Order of a cycle around its tick t (a multiple of 2 minutes UTC):
//   t - read_lead_s  battery measurements        t  the row of minute t-1 is requested
//   row in, or price_wait_s over                 decision, order written and read back
#pragma once

#include <cstdint>

#include "edge/control_types.h"
#include "edge/policy.h"
#include "edge/registers/codec.h"
#include "edge/safety_guard.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

struct ControlSettings {
  bool control = false;  ///< false: everything but writing
  GuardSettings guard;
  std::int32_t order_duration_s = 300;  ///< of the device's dead-man timer
  std::int32_t hold_s = 300;            ///< 0 W held after a stop reason before releasing
  std::int32_t price_wait_s = 20;
  std::int32_t read_lead_s = 3;
};

constexpr std::int64_t next_tick_utc_s(std::int64_t now_utc_s) {
  return (now_utc_s / kSecondsPerStep + 1) * kSecondsPerStep;
}

template <typename Battery, typename PriceSource, typename Clock>
class ControlLoop {
 public:
  ControlLoop(const ControlSettings& settings, Battery& battery, PriceSource& prices, Clock& clock)
      : settings_(settings),
        battery_(battery),
        prices_(prices),
        clock_(clock),
        guard_(settings.guard) {}

  /// Runs the cycle of the next tick; false when the process was asked to stop before it.
  bool run_cycle(CycleRecord& record) {
    const std::int64_t now_utc_s = clock_.now_utc_ns() / kNanosecondsPerSecond;
    const std::int64_t tick_utc_s = next_tick_utc_s(now_utc_s);
    count_missed_ticks(tick_utc_s);
    record = CycleRecord{.utc_s = tick_utc_s, .cycle = ++cycle_};
    if (!sleep_until_s(tick_utc_s - settings_.read_lead_s)) return false;
    request_price(tick_utc_s);  // before the battery is read: a slow bus must not cost the price
    read_battery(record);
    if (!sleep_until_s(tick_utc_s)) return false;
    await_price(record);
    if (clock_.stop_requested()) return false;
    decide(record);
    act(record);
    record.missed_ticks = missed_ticks_;
    return true;
  }

  /// Safe state: 0 W, then release. Called once on every way out; harmless when nothing was
  /// ordered.
  Status stop(CycleRecord& record) {
    mode_ = Mode::kStopping;
    record = CycleRecord{.utc_s = clock_.now_utc_ns() / kNanosecondsPerSecond,
                         .cycle = cycle_,
                         .mode = mode_,
                         .reason = Reason::kStopRequested,
                         .battery_status = Status::kOk,
                         .missed_ticks = missed_ticks_};
    if (!settings_.control || !has_ordered_) return Status::kOk;
    write_order(0, record);
    const Status zero_status = record.battery_status;
    write_release(record);
    if (record.battery_status == Status::kOk) record.battery_status = zero_status;
    const Status status = record.battery_status;
    if (status == Status::kOk) read_battery(record);  // the SoC that is left, for the log
    return status;
  }

 private:
  bool sleep_until_s(std::int64_t utc_s) {
    return clock_.sleep_until_utc_ns(utc_s * kNanosecondsPerSecond);
  }

  void count_missed_ticks(std::int64_t tick_utc_s) {
    if (last_tick_utc_s_ != 0 && tick_utc_s > last_tick_utc_s_ + kSecondsPerStep) {
      missed_ticks_ +=
          static_cast<std::int32_t>((tick_utc_s - last_tick_utc_s_) / kSecondsPerStep - 1);
    }
    last_tick_utc_s_ = tick_utc_s;
  }

  void read_battery(CycleRecord& record) {
    record.battery_status = battery_.read(record.measurement);
    record.has_measurement = record.battery_status == Status::kOk;
    if (!record.has_measurement) record.measurement = BatteryMeasurement{};
  }

  std::int64_t price_deadline_ns(std::int64_t tick_utc_s) const {
    return clock_.monotonic_ns_at((tick_utc_s + settings_.price_wait_s) * kNanosecondsPerSecond);
  }

  void request_price(std::int64_t tick_utc_s) {
    request_ns_ = clock_.monotonic_ns();
    prices_.request(tick_utc_s - 60, clock_.monotonic_ns_at(tick_utc_s * kNanosecondsPerSecond),
                    price_deadline_ns(tick_utc_s));
  }

  /// Waits for the row of the minute before the tick, in slices so that a stop request is seen.
  void await_price(CycleRecord& record) {
    constexpr std::int64_t kSliceNs = kNanosecondsPerSecond / 10;
    const std::int64_t deadline_ns = price_deadline_ns(record.utc_s);
    while (!clock_.stop_requested()) {
      const std::int64_t now_ns = clock_.monotonic_ns();
      if (now_ns >= deadline_ns) break;
      const std::int64_t slice_ns = now_ns + kSliceNs;
      if (prices_.wait(slice_ns < deadline_ns ? slice_ns : deadline_ns)) break;
    }
    record.price = prices_.latest();
    if (record.price.has_row) {
      record.price_age_s =
          static_cast<std::int32_t>(price_age_s(record.utc_s, record.price.minute_utc_s));
    }
  }

  void decide(CycleRecord& record) {
    const std::int64_t start_ns = clock_.monotonic_ns();
    if (record.has_measurement && record.price.has_row) {
      const LatticeState state =
          make_lattice_state(local_minute_of(record.utc_s), record.measurement.soc_e4,
                             record.price.price_centi_eur_per_mwh);
      record.student_action = decide_with_student(state);
      record.has_student_action = true;
    }
    const GuardDecision decision =
        guard_.decide({.now_utc_s = record.utc_s,
                       .clock_ok = clock_.is_synchronised(),
                       .link_ok = record.has_measurement,
                       .measurement = record.measurement,
                       .has_price = record.price.has_row,
                       .price_minute_utc_s = record.price.minute_utc_s,
                       .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh,
                       .student_action = record.student_action});
    record.reason = decision.reason;
    record.ordered_power_w = decision.power_w;
    advance_mode(record);
    record.decision_us = elapsed_us(start_ns);
  }

  void advance_mode(CycleRecord& record) {
    const bool hold_elapsed = record.utc_s - hold_start_utc_s_ >= settings_.hold_s;
    const Mode before = mode_;
    mode_ = next_mode(mode_, {.stop_requested = clock_.stop_requested(),
                              .stop_reason = is_stop_reason(record.reason),
                              .hold_elapsed = hold_elapsed});
    if (mode_ == Mode::kHolding && before != Mode::kHolding) hold_start_utc_s_ = record.utc_s;
    record.mode = mode_;
  }

  void act(CycleRecord& record) {
    if (!settings_.control) return;
    const std::int64_t start_ns = clock_.monotonic_ns();
    switch (mode_) {
      case Mode::kRunning:
        write_order(record.ordered_power_w, record);
        break;
      case Mode::kHolding:
        write_order(0, record);
        break;
      case Mode::kSafe:
        if (has_ordered_) write_release(record);
        break;
      case Mode::kStart:
      case Mode::kStopping:
        break;
    }
    record.write_us = elapsed_us(start_ns);
    const bool fresh = record.price.has_row && record.price.received_monotonic_ns >= request_ns_;
    if (record.written && fresh) {
      record.total_us = elapsed_us(record.price.received_monotonic_ns);
    }
  }

  void write_order(std::int32_t power_w, CycleRecord& record) {
    has_ordered_ = true;  // even when it fails: the battery may have understood
    record.ordered_power_w = power_w;
    record.battery_status = battery_.order({.power_w = power_w,
                                            .soc_min_e4 = settings_.guard.soc_min_e4,
                                            .soc_max_e4 = settings_.guard.soc_max_e4,
                                            .duration_s = settings_.order_duration_s});
    record.written = record.battery_status == Status::kOk;
  }

  void write_release(CycleRecord& record) {
    record.ordered_power_w = 0;
    record.battery_status = battery_.release();
    record.written = record.battery_status == Status::kOk;
    if (record.written) has_ordered_ = false;
  }

  std::int32_t elapsed_us(std::int64_t start_ns) {
    return static_cast<std::int32_t>((clock_.monotonic_ns() - start_ns) / 1'000);
  }

  ControlSettings settings_;
  Battery& battery_;
  PriceSource& prices_;
  Clock& clock_;
  SafetyGuard guard_;
  Mode mode_ = Mode::kStart;
  std::int64_t cycle_ = 0;
  std::int64_t last_tick_utc_s_ = 0;
  std::int64_t hold_start_utc_s_ = 0;
  std::int64_t request_ns_ = 0;  ///< when this cycle asked for its price
  std::int32_t missed_ticks_ = 0;
  bool has_ordered_ = false;  ///< an order may be in force at the battery
};

}  // namespace bess
