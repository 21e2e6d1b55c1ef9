// Control loop: one control cycle reads the battery, waits for the newest price, decides, guards,
// orders and records. A template over battery, price source and clock: the same code runs against
// Modbus and HTTP, against the battery model in tests, and in simulated time. No virtual functions,
// no allocation.
//
//   Battery      Status read(BatteryMeasurement&), order(const PowerOrder&), refresh(), release();
//                int32 refresh_interval_s();  BatteryCounters counters()
//   PriceSource  void request(minute_utc_s, start_monotonic_ns, deadline_monotonic_ns);
//                bool wait(until_monotonic_ns);  PriceReport latest()
//   Site         house, meter and outside limits (site_limits.h); NoSite: none
//   Clock        now_utc_ns(), monotonic_ns(), monotonic_ns_at(utc_ns), sleep_until_utc_ns(utc_ns),
//                pause_ns(ns), stop_requested(), is_synchronised()
//
// Order of a cycle around its tick t (a multiple of 2 minutes UTC):
//   t - read_lead_s  battery and site measured   t  the row of minute t-1 is requested
//   row in, or price_wait_s over                 decision, order written and read back
// Between cycles: battery_monitor.h. Parts of a decision: cycle_parts.h.
#pragma once

#include <cstdint>
#include <optional>

#include "edge/core/control/level_start.h"
#include "edge/core/control/policy.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/loop/battery_monitor.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/loop/cycle_parts.h"
#include "edge/core/loop/order_in_force.h"
#include "edge/core/loop/tick_scheduler.h"

namespace bess {

// Decision inputs in addition to those of the cycle parts: the record's reading and price, and the
// student.

/// `now_utc_s`: the tick, or later if more than the price wait has passed.
inline GuardInputs guard_inputs(const CycleRecord& record, std::int64_t now_utc_s,
                                std::int32_t price_age_s_max) {
  // Suspended between reading and deciding: a reading may be as old as a price, not older.
  const bool is_recent = now_utc_s - record.utc_s <= price_age_s_max;
  return {.now_utc_s = now_utc_s,
          .link_ok = record.has_measurement && is_recent,
          .measurement = record.measurement,
          .has_price = record.price.has_row,
          .price_minute_utc_s = record.price.minute_utc_s,
          .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh};
}

/// Replaces a price that is too old to trade on by an estimate, if the guard permits.
inline void allow_stand_in(const SafetyGuard& guard, const PriceLevel& level, CycleRecord& record,
                           GuardInputs& in) {
  if (!level.is_known() || !guard.may_stand_in(in)) return;
  in.price_centi_eur_per_mwh = stand_in_centi(in.price_centi_eur_per_mwh, level.centi_eur_per_mwh(),
                                              price_age_s(in.now_utc_s, in.price_minute_utc_s));
  in.price_stands_in = record.price_stands_in = true;
  record.stand_in_centi_eur_per_mwh = in.price_centi_eur_per_mwh;
}

/// Student's action and rule limits, if battery and price are known.
inline void ask_student(const PriceLevel& level, OutlookPart& outlook, CycleRecord& record,
                        GuardInputs& in) {
  if (!record.has_measurement || !record.price.has_row) return;
  const std::int32_t price_centi = decided_price_centi(record);
  const LocalMinute now = local_minute_of(record.utc_s);
  record.context_class = student_context_class(now, outlook.context_centi(level, record));
  const LatticeState state =
      make_lattice_state(now, record.context_class, record.measurement.soc_e4, price_centi);
  record.student_action = decide_with_student(state);
  record.has_student_action = true;
  in.student_action = record.student_action;
  in.rules = student_rule_limits(now, state, price_centi);
}

/// A device that responds with a wrong identity or capacity was stopped for that, not because it
/// could not be read.
constexpr Reason cause_of(Reason reason, std::optional<Reason> supervision, Status battery_status) {
  const bool is_implausible = reason == Reason::kLink && battery_status == Status::kImplausible;
  return is_implausible ? supervision.value_or(reason) : reason;
}

inline void note_price_age(std::int64_t utc_s, CycleRecord& record) {
  if (!record.price.has_row) return;
  record.price_age_s = static_cast<std::int32_t>(price_age_s(utc_s, record.price.minute_utc_s));
}

template <typename Battery, typename PriceSource, typename Clock, typename Site = NoSite>
class ControlLoop {
 public:
  ControlLoop(const ControlSettings& settings, Battery& battery, PriceSource& prices, Clock& clock,
              const Site& site = Site())
      : settings_(settings),
        clock_(clock),
        guard_(settings.guard),
        parts_(settings_, site),
        order_(settings_, battery, clock),
        battery_(battery),
        watch_(settings_, battery, clock, order_, parts_, guard_, mode_),
        waits_(settings_, prices, clock, order_, watch_) {}

  /// A cycle of an earlier run, oldest first and before `take_over`.
  void recall(const CycleRecord& record) {
    parts_.recall(record, settings_.control);
    order_.set_ahead(of<SupervisionPart>().time.ahead_s());
  }

  /// State of an earlier run: its newest record (empty if none), and the trip in force.
  void take_over(const CycleRecord& before, const std::optional<Trip>& trip = std::nullopt) {
    parts_.restore(before);
    of<SupervisionPart>().take_over(before, trip);
    order_.expect(before);
  }

  /// Follows the holds published there; `holds` must outlive the loop.
  void follow_holds(const LatestHold& holds) { of<HoldPart>().latest_hold = &holds; }
  /// Plans for a student by outlook; null for other contexts.
  void follow_outlook(OutlookExchange* exchange) { of<OutlookPart>().exchange = exchange; }

  [[nodiscard]] const std::optional<Trip>& trip() const {
    return parts_.template get<SupervisionPart>().supervision.trip();
  }
  /// Cleared by a person: the battery may be driven again.
  void clear_trip() { of<SupervisionPart>().supervision.clear(); }

  /// Runs the cycle of the next tick; false if a stop was requested before it.
  bool run_cycle(CycleRecord& record) {
    std::int64_t tick_utc_s = 0;
    if (!waits_.await_next_tick(tick_utc_s)) return false;
    order_.bind(tick_utc_s);
    record = CycleRecord{.utc_s = tick_utc_s, .cycle = ++cycle_};
    waits_.request_price();  // before the battery is read: a slow bus must not cost the price
    watch_.read(ReadingPurpose::kTick, record);
    if (!waits_.sleep_until_tick()) return false;
    record.price = waits_.await_price();
    note_price_age(record.utc_s, record);
    if (clock_.stop_requested()) return false;
    decide(record);
    act(record);
    count_deadline_miss(record);
    fill_totals(record);
    return true;
  }

  /// The last order lasts its whole step; returns early on a stop request.
  void finish_step() { waits_.finish_step(); }

  /// Safe state: 0 W, then release. Called once on every exit; harmless without an order. Without a
  /// device timer that would end the order it retries for longer than the link pauses between two
  /// connects.
  void stop(CycleRecord& record) {
    record = final_record(Reason::kStopRequested);
    if (settings_.control && !order_.has_looked()) {
      watch_.read(ReadingPurpose::kLast, record);  // an order of the run before
      record.battery_status = Status::kOk;
    }
    if (!settings_.control || !order_.exists()) return;
    const std::int64_t last_ns = clock_.now_utc_ns() + kStopPatienceNs;
    Status released = give_back(record);
    while (order_.exists() && !settings_.has_watchdog && clock_.now_utc_ns() < last_ns) {
      clock_.pause_ns(kStopPauseNs);
      released = give_back(record);
    }
    if (released == Status::kOk)
      watch_.read(ReadingPurpose::kLast, record);  // the final SoC, for the log
    record.battery_status = released;
    fill_totals(record);
  }

  [[nodiscard]] bool is_in_control() const { return settings_.control; }
  /// False: the last order stays in force until another controller ends it.
  [[nodiscard]] bool order_ends_by_itself() const { return settings_.has_watchdog; }

  /// Ends without touching the battery, so that the next run takes over; otherwise its watchdog
  /// ends the order. False without a watchdog or an order in force: then stop.
  bool hand_over(CycleRecord& record) {
    if (!settings_.has_watchdog || !order_.exists()) return false;
    record = final_record(Reason::kHandOver);
    record.ordered_power_w = order_.power_w();
    record.followed = {.is_judged = true, .power_w = order_.power_w(), .age_s = order_.age_s()};
    return true;
  }

 private:
  static constexpr std::int64_t kStopPatienceNs = 65 * kNanosecondsPerSecond;
  static constexpr std::int64_t kStopPauseNs = 5 * kNanosecondsPerSecond;

  Status give_back(CycleRecord& record) {
    write_order(0, record, order_.write_until_ns());
    const Status zero_status = record.battery_status;
    write_release(record);
    if (record.battery_status == Status::kOk) record.battery_status = zero_status;
    return record.battery_status;
  }

  CycleRecord final_record(Reason reason) {
    mode_ = Mode::kStopping;
    CycleRecord record{.utc_s = utc_seconds(clock_),
                       .cycle = cycle_,
                       .mode = mode_,
                       .reason = reason,
                       .battery_status = Status::kOk};
    fill_totals(record);
    return record;
  }

  void decide(CycleRecord& record) {
    const std::int64_t start_ns = clock_.monotonic_ns();
    GuardInputs in =
        guard_inputs(record, decision_utc_s(record.utc_s), settings_.guard.price_age_s_max);
    in.clock_ok = clock_.is_synchronised();
    in.previous_power_w = order_.power_w();
    parts_.put({}, record, in);
    allow_stand_in(guard_, of<FullChargePart>().level, record, in);
    ask_student(of<FullChargePart>().level, of<OutlookPart>(), record, in);
    const GuardDecision decision = guard_.decide(in);
    record.reason = cause_of(decision.reason, in.supervision, record.battery_status);
    record.ordered_power_w = decision.power_w;
    parts_.note(decision.power_w);
    advance_mode(record);
    record.decision_us = elapsed_us(start_ns);
  }

  /// The tick, or later if more than the price wait has passed: after a suspend or a clock jump old
  /// data must not count as new.
  std::int64_t decision_utc_s(std::int64_t tick_utc_s) const {
    const std::int64_t latest_utc_s = utc_seconds(clock_) - settings_.price_wait_s;
    return latest_utc_s > tick_utc_s ? latest_utc_s : tick_utc_s;
  }

  void advance_mode(CycleRecord& record) {
    const std::int64_t held_s = record.utc_s - hold_start_utc_s_;
    // A clock step backwards does not extend it.
    const bool hold_elapsed = held_s >= settings_.hold_s || held_s < 0;
    const Mode before = mode_;
    mode_ = next_mode(mode_, {.stop_requested = clock_.stop_requested(),
                              .stop_reason = is_stop_reason(record.reason),
                              .hold_elapsed = hold_elapsed,
                              .release_now = must_release(record.reason),
                              .order_found = order_.was_found()});
    if (mode_ == Mode::kHolding && before != Mode::kHolding) hold_start_utc_s_ = record.utc_s;
    record.mode = mode_;
  }

  void act(CycleRecord& record) {
    if (!settings_.control) {
      order_.imagine(record.ordered_power_w);
      return;
    }
    const std::int64_t start_ns = clock_.monotonic_ns();
    const Status reading_status = record.battery_status;
    watch_.forget_failed_cut();
    if (mode_ == Mode::kRunning) {
      write_order(record.ordered_power_w, record, order_.write_until_ns());
      if (record.has_measurement) {
        of<SupervisionPart>().supervision.on_ordered(utc_seconds(clock_), record.battery_status);
      }
    } else if (mode_ == Mode::kHolding) {
      write_order(0, record, order_.write_until_ns());
    } else if (mode_ == Mode::kSafe && order_.exists()) {
      write_release(record);
    }
    record.write_us = elapsed_us(start_ns);
    if (record.battery_status == Status::kOk) record.battery_status = reading_status;
    if (record.written && waits_.is_fresh(record.price)) {
      record.total_us = elapsed_us(record.price.received_monotonic_ns);
    }
  }

  void write_order(std::int32_t power_w, CycleRecord& record, std::int64_t write_until_ns) {
    note_price_age(utc_seconds(clock_), record);
    record.ordered_power_w = power_w;
    record.battery_status = order_.write(power_w, of<ReservePart>().soc_e4, write_until_ns);
    record.written = record.battery_status == Status::kOk;
  }

  void write_release(CycleRecord& record) {
    record.ordered_power_w = 0;
    record.battery_status = order_.release();
    record.written = record.battery_status == Status::kOk;
  }

  /// A deadline miss: a required order not in force `order_deadline_s` after its tick.
  void count_deadline_miss(const CycleRecord& record) {
    const bool needed = settings_.control && (mode_ == Mode::kRunning || mode_ == Mode::kHolding);
    const std::int64_t deadline_s = record.utc_s + settings_.order_deadline_s;
    const bool in_time = clock_.now_utc_ns() <= deadline_s * kNanosecondsPerSecond;
    if (needed && !(record.written && in_time)) ++deadline_misses_;
  }

  void fill_totals(CycleRecord& record) const {
    record.missed_ticks = waits_.missed_ticks();
    record.deadline_misses = deadline_misses_;
    parts_.report(record);
    record.site.order_cuts = watch_.order_cuts();
    record.counters = battery_.counters();
  }

  std::int32_t elapsed_us(std::int64_t start_ns) {
    return static_cast<std::int32_t>((clock_.monotonic_ns() - start_ns) / 1'000);
  }

  template <typename Part>
  Part& of() {
    return parts_.template get<Part>();
  }

  ControlSettings settings_;
  Clock& clock_;
  SafetyGuard guard_;
  CycleParts<Site> parts_;
  OrderInForce<Battery, Clock> order_;
  Mode mode_ = Mode::kStart;
  Battery& battery_;
  BatteryMonitor<Battery, Clock, Site> watch_;
  TickScheduler<Battery, PriceSource, Clock, Site> waits_;
  std::int64_t cycle_ = 0;
  std::int64_t hold_start_utc_s_ = 0;
  std::int32_t deadline_misses_ = 0;
};

}  // namespace bess
