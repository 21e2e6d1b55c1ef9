// One cycle of the controller: read the battery, wait for the newest price, decide, guard, order,
// record. A template over battery, price source and clock, so that the very same code runs against
// Modbus and HTTP, against the battery model in tests, and in simulated time; nothing is virtual,
// nothing allocates.
//
//   Battery      Status read(BatteryMeasurement&), order(const PowerOrder&), refresh(), release();
//                int32 refresh_interval_s();  BatteryCounters counters()
//   PriceSource  void request(minute_utc_s, start_monotonic_ns, deadline_monotonic_ns);
//                bool wait(until_monotonic_ns);  PriceReport latest()
//   Site         the house behind the same meter and who limits it (site_limits.h); NoSite: nothing
//   Clock        now_utc_ns(), monotonic_ns(), monotonic_ns_at(utc_ns), sleep_until_utc_ns(utc_ns),
//                pause_ns(ns), stop_requested(), is_synchronised()
//
// Order of a cycle around its tick t (a multiple of 2 minutes UTC):
//   t - read_lead_s  battery and site measured   t  the row of minute t-1 is requested
//   row in, or price_wait_s over, and not before
//   start_offset_ms after the tick               decision, order written and read back
// Between cycles the battery's watchdog is fed as often as its register map asks, and an order that
// the site no longer bears is cut.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/control/control_types.h"
#include "edge/control/cycle_budget.h"
#include "edge/control/frozen_price.h"
#include "edge/control/full_charge.h"
#include "edge/control/hold.h"
#include "edge/control/policy.h"
#include "edge/control/reserve.h"
#include "edge/control/safety_guard.h"
#include "edge/control/tick.h"
#include "edge/loop/control_settings.h"
#include "edge/loop/order_in_force.h"
#include "edge/loop/recalled_time.h"
#include "edge/site/site_limits.h"
#include "edge/supervision/supervision.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {

/// What an earlier run of the program left behind, by its own log.
struct TakeOver {
  DayThroughput throughput{};
  PriceLevel price_level{};
  Trip trip{};
  LostOrderHistory lost_orders{};
  ReversalHistory reversals{};
  std::int32_t last_full_day = 0;  ///< full_charge.h
  SiteReport site{};
  StandingPrice standing_price{};
  std::int32_t ordered_power_w = 0;
  std::int64_t ordered_since_utc_s = 0;  ///< when that power was ordered first
  std::int64_t utc_s = 0;                ///< of that log's newest record
};

template <typename Battery, typename PriceSource, typename Clock, typename Site = NoSite>
class ControlLoop {
 public:
  ControlLoop(const ControlSettings& settings, Battery& battery, PriceSource& prices, Clock& clock,
              const Site& site = Site())
      : settings_(settings),
        battery_(battery),
        prices_(prices),
        clock_(clock),
        site_(site),
        guard_(settings.guard),
        cycle_budget_(settings.cycles_per_day_max_e4),
        reversal_cap_(settings.reversals_per_hour_max),
        full_charge_(settings.full_charge_every_days),
        frozen_price_(settings.frozen_price),
        supervision_(settings.supervision),
        order_(settings_, battery, clock) {}

  /// A cycle of an earlier run, oldest first and before `take_over`: what supervision has found by then,
  /// short of a trip, is found again. Who kills the program between two readings hides nothing.
  void recall(const CycleRecord& record) {
    const PriceReport& price = record.price;
    if (price.has_row) frozen_price_.recall(price.minute_utc_s, price.price_centi_eur_per_mwh);
    if (!settings_.control || !record.has_measurement) return;
    supervision_.recall(recalled_response(record));
    order_.set_ahead(recalled_time_.ahead_s());
    if (record.mode == Mode::kRunning) {
      supervision_.on_ordered(record.utc_s, record.battery_status);
    }
  }

  void take_over(const TakeOver& before) {
    cycle_budget_.restore(before.throughput);
    price_level_ = before.price_level;
    supervision_.restore(before.trip);
    supervision_.restore(before.lost_orders, before.utc_s + recalled_time_.ahead_s());
    reversal_cap_.restore(before.reversals, before.utc_s);
    full_charge_.restore(before.last_full_day);
    site_.take_over(before.utc_s, before.site);
    frozen_price_.restore(before.standing_price);
    order_.expect(before.ordered_power_w, before.utc_s, before.ordered_since_utc_s);
  }

  /// Follows the holds that are published there, which outlives the loop.
  void follow_holds(const HoldMailbox& holds) { holds_ = &holds; }

  [[nodiscard]] const Trip& trip() const { return supervision_.trip(); }
  /// A person has looked: the battery may be driven again.
  void clear_trip() { supervision_.clear(); }

  /// Runs the cycle of the next tick; false when the process was asked to stop before it.
  bool run_cycle(CycleRecord& record) {
    std::int64_t tick_utc_s = 0;
    if (!await_next_tick(tick_utc_s)) return false;
    count_missed_ticks(tick_utc_s);
    order_.bind(tick_utc_s);
    record = CycleRecord{.utc_s = tick_utc_s, .cycle = ++cycle_};
    request_price(tick_utc_s);  // before the battery is read: a slow bus must not cost the price
    read_battery(record);
    observe_site(record.has_measurement, record.measurement);
    if (!sleep_until_s(tick_utc_s)) return false;
    await_price(record);
    if (!await_start(tick_utc_s) || clock_.stop_requested()) return false;
    decide(record);
    act(record);
    count_deadline_miss(record);
    fill_totals(record);
    return true;
  }

  /// The last order keeps its whole step; returns early when a stop is requested.
  void finish_step() { sleep_until_s(last_tick_utc_s_ + kSecondsPerStep); }

  /// Safe state: 0 W, then release. Called once on every way out; harmless when nothing was
  /// ordered. Where no timer of the device would end the order, it is tried for longer than the
  /// link pauses between two connects.
  void stop(CycleRecord& record) {
    record = final_record(Reason::kStopRequested);
    if (settings_.control && !order_.has_looked()) {
      read_battery(record);  // of the run before
      record.battery_status = Status::kOk;
    }
    if (!settings_.control || !order_.exists()) return;
    const std::int64_t last_ns = clock_.now_utc_ns() + kStopPatienceNs;
    Status released = give_back(record);
    while (order_.exists() && !settings_.has_watchdog && clock_.now_utc_ns() < last_ns) {
      clock_.pause_ns(kStopPauseNs);
      released = give_back(record);
    }
    if (released == Status::kOk) read_battery(record);  // the SoC that is left, for the log
    record.battery_status = released;
    fill_totals(record);
  }

  [[nodiscard]] bool is_in_control() const { return settings_.control; }
  /// False: what was ordered last stays in force until somebody ends it.
  [[nodiscard]] bool order_ends_by_itself() const { return settings_.has_watchdog; }

  /// Ends without touching the battery, for the next run to take over; its watchdog ends the order
  /// if none comes. False when it has none, or no order is in force: then stop.
  bool hand_over(CycleRecord& record) {
    if (!settings_.has_watchdog || !order_.exists()) return false;
    record = final_record(Reason::kHandOver);
    record.ordered_power_w = order_.power_w();
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
    CycleRecord record{.utc_s = now_utc_s(),
                       .cycle = cycle_,
                       .mode = mode_,
                       .reason = reason,
                       .battery_status = Status::kOk};
    fill_totals(record);
    return record;
  }

  [[nodiscard]] std::int64_t now_utc_s() const {
    return clock_.now_utc_ns() / kNanosecondsPerSecond;
  }

  /// Sleeps until `read_lead_s` before the next tick. A clock that is stepped back meanwhile has
  /// other ticks.
  bool await_next_tick(std::int64_t& tick_utc_s) {
    do {
      tick_utc_s = next_tick_utc_s(now_utc_s());
      if (!sleep_until_s(tick_utc_s - settings_.read_lead_s)) return false;
    } while (now_utc_s() < tick_utc_s - kSecondsPerStep - settings_.read_lead_s);
    return true;
  }

  /// Sleeps, feeds the battery's watchdog and looks after the site meanwhile; false when asked to
  /// stop. Returns early when the clock was stepped back: the instant may lie hours ahead by now.
  bool sleep_until_s(std::int64_t utc_s) { return sleep_until_ns(utc_s * kNanosecondsPerSecond); }

  bool sleep_until_ns(std::int64_t until_ns) {
    while (true) {
      const std::int64_t before_ns = clock_.now_utc_ns();
      const std::int64_t refresh_ns = order_.refresh_due_utc_ns();
      const std::int64_t check_ns = site_due_utc_ns();
      const std::int64_t due_ns = refresh_ns < check_ns ? refresh_ns : check_ns;
      if (due_ns >= until_ns) return clock_.sleep_until_utc_ns(until_ns);
      if (!clock_.sleep_until_utc_ns(due_ns)) return false;
      if (refresh_ns == due_ns) {
        order_.refresh();
      } else {
        check_site();
      }
      if (clock_.now_utc_ns() < before_ns) return true;
    }
  }

  std::int64_t site_due_utc_ns() const {
    const std::int32_t interval_s = site_.check_every_s();
    if (interval_s <= 0) return INT64_MAX;
    const std::int64_t now_ns = clock_.now_utc_ns();
    if (site_utc_ns_ > now_ns) return now_ns;  // the clock was stepped back meanwhile
    return site_utc_ns_ + interval_s * kNanosecondsPerSecond;
  }

  void observe_site(bool is_read, const BatteryMeasurement& measurement) {
    const Response now = order_.response(measurement);
    site_.observe(now_utc_s(), is_read, measurement,
                  {.is_driven = is_read && now.is_driven, .age_s = now.order_age_s});
    site_utc_ns_ = clock_.now_utc_ns();
  }

  [[nodiscard]] SiteRange site_range(std::int64_t utc_s, Margin margin) const {
    return site_.range(utc_s, settings_.guard.power_w, margin);
  }

  /// Between two ticks: what the site no longer bears of the order in force is taken off it. Only a
  /// tick gives it back.
  void check_site() {
    BatteryMeasurement measurement;
    bool is_read = site_.needs_battery() && battery_.read(measurement) == Status::kOk;
    observe_site(is_read, measurement);
    if (!settings_.control || !order_.exists() || mode_ != Mode::kRunning) return;
    const BatteryMeasurement& known = is_read ? measurement : measured_;
    if (bearable_power_w(known, Margin::kHalf) == order_.power_w() && !cut_failed_) return;
    const std::int32_t power_w = bearable_power_w(known, Margin::kWhole);
    if (!site_.needs_battery()) is_read = battery_.read(measurement) == Status::kOk;
    // What became of our order is for the tick to see, and not to be hidden by the next one. Some follow
    // none of 0 W: there is nothing to hide.
    const bool has_ended = measurement.order_ended && order_.drives();
    if (is_read && (measurement.order_replaced || has_ended)) return;
    if (is_read) account_until_cut(measurement);
    cut_order(power_w);
  }

  /// Of the order in force.
  [[nodiscard]] std::int32_t bearable_power_w(const BatteryMeasurement& measurement,
                                              Margin margin) const {
    return guard_
        .recheck({.measurement = measurement,
                  .cycle_budget_spent = cycle_budget_.is_spent(),
                  .barred_direction = reversal_cap_.barred_direction(),
                  .previous_power_w = order_.power_w(),
                  .reserve_soc_e4 = reserve_soc_e4_,
                  .site = site_range(now_utc_s(), margin)})
        .power_w;
  }

  /// What flowed under the order until now would be taken for the next one's at the next reading.
  void account_until_cut(const BatteryMeasurement& measurement) {
    const Response now = order_.response(measurement);
    count_cycles(now.utc_s, measurement);
    supervision_.note_power(now);
  }

  /// As fresh as the readings that it follows from, and never longer than its cycle's order.
  void cut_order(std::int32_t power_w) {
    if (power_w != order_.power_w()) ++order_cuts_;
    was_cut_ = true;
    CycleRecord between;  // the next cycle's record says what became of it
    write_order(
        power_w, between,
        std::min(order_.feed_until_ns(),
                 clock_.monotonic_ns() + settings_.order_deadline_s * kNanosecondsPerSecond));
    cut_failed_ = !between.written;
    reversal_cap_.note(power_w);
  }

  void count_missed_ticks(std::int64_t tick_utc_s) {
    if (last_tick_utc_s_ != 0 && tick_utc_s > last_tick_utc_s_ + kSecondsPerStep) {
      missed_ticks_ +=
          static_cast<std::int32_t>((tick_utc_s - last_tick_utc_s_) / kSecondsPerStep - 1);
    }
    last_tick_utc_s_ = tick_utc_s;
  }

  [[nodiscard]] Response recalled_response(const CycleRecord& record) {
    return {.utc_s = record.utc_s - settings_.read_lead_s,
            .steady_s = recalled_time_.steady_s(record, settings_.read_lead_s),
            .is_driven = record.followed.is_judged,
            .ordered_power_w = record.followed.power_w,
            .order_age_s = record.followed.age_s,
            .soc_floor_e4 = record.followed.soc_floor_e4,
            .measurement = record.measurement};
  }

  void read_battery(CycleRecord& record) {
    record.battery_status = battery_.read(record.measurement);
    record.has_measurement = record.battery_status == Status::kOk;
    if (!record.has_measurement) {
      const std::int32_t capacity_wh = record.measurement.capacity_wh;
      if (settings_.control && capacity_wh > 0) supervision_.note_capacity(capacity_wh);
      record.measurement = BatteryMeasurement{};
      cycle_budget_.forget_soc();
      return;
    }
    measured_ = record.measurement;
    order_.find(record.measurement);
    count_cycles(record.utc_s, record.measurement);
    full_charge_.update(local_day_number(local_minute_of(record.utc_s)), record.measurement.soc_e4);
    if (!settings_.control) return;
    const Response response = order_.response(record.measurement);
    supervision_.observe(response, !order_.exists());
    record.followed = {.is_judged = response.is_driven && !was_cut_,
                       .power_w = response.ordered_power_w,
                       .age_s = response.order_age_s,
                       .soc_floor_e4 = static_cast<std::int16_t>(response.soc_floor_e4)};
    was_cut_ = false;
  }

  void count_cycles(std::int64_t utc_s, const BatteryMeasurement& measurement) {
    cycle_budget_.update(local_day_of(local_minute_of(utc_s)), measurement.soc_e4, order_.drives());
  }

  std::int64_t price_deadline_ns(std::int64_t tick_utc_s) const {
    return bounded_monotonic_ns(clock_, tick_utc_s + settings_.price_wait_s,
                                settings_.price_wait_s + settings_.read_lead_s);
  }

  void request_price(std::int64_t tick_utc_s) {
    request_ns_ = clock_.monotonic_ns();
    prices_.request(tick_utc_s - 60,
                    bounded_monotonic_ns(clock_, tick_utc_s, settings_.read_lead_s),
                    price_deadline_ns(tick_utc_s));
  }

  /// Waits for the row of the minute before the tick, in slices so that a stop request is seen.
  void await_price(CycleRecord& record) {
    constexpr std::int64_t kSliceNs = kNanosecondsPerSecond / 10;
    const std::int64_t deadline_ns = price_deadline_ns(record.utc_s);
    while (!clock_.stop_requested()) {
      const std::int64_t now_ns = clock_.monotonic_ns();
      if (now_ns >= deadline_ns) break;
      if (clock_.now_utc_ns() >= order_.refresh_due_utc_ns()) order_.refresh();
      const std::int64_t slice_ns = now_ns + kSliceNs;
      if (prices_.wait(slice_ns < deadline_ns ? slice_ns : deadline_ns)) break;
    }
    record.price = prices_.latest();
    note_price_age(record.utc_s, record);
  }

  static void note_price_age(std::int64_t utc_s, CycleRecord& record) {
    if (!record.price.has_row) return;
    record.price_age_s = static_cast<std::int32_t>(price_age_s(utc_s, record.price.minute_utc_s));
  }

  /// Before the decision, so that what is decided is ordered at once. What was late already, a price
  /// or a battery, is not made later.
  bool await_start(std::int64_t tick_utc_s) {
    if (settings_.start_offset_ms == 0) return true;
    return sleep_until_ns(tick_utc_s * kNanosecondsPerSecond +
                          std::int64_t{settings_.start_offset_ms} * 1'000'000);
  }

  /// What people want of this cycle: a hold, and a reserve at this hour.
  void take_wishes(CycleRecord& record) {
    if (holds_ != nullptr) record.hold = hold_at(holds_->latest(), record.utc_s);
    record.reserve_soc_e4 = reserve_soc_e4_at(settings_.reserve, local_minute_of(record.utc_s));
    reserve_soc_e4_ = record.reserve_soc_e4;
  }

  void decide(CycleRecord& record) {
    const std::int64_t start_ns = clock_.monotonic_ns();
    take_wishes(record);
    RuleLimits rules;
    const PriceReport& price = record.price;
    if (price.has_row) note_price(price);
    if (record.has_measurement && price.has_row) {
      const LocalMinute now = local_minute_of(record.utc_s);
      record.context_class = student_context_class(now, price_level_);
      const LatticeState state = make_lattice_state(
          now, record.context_class, record.measurement.soc_e4, price.price_centi_eur_per_mwh);
      record.student_action = decide_with_student(state);
      rules = student_rule_limits(now, state, price.price_centi_eur_per_mwh);
      record.has_student_action = true;
    }
    reversal_cap_.advance(record.utc_s);
    const std::int64_t decided_utc_s = decision_utc_s(record.utc_s);
    // Suspended between reading and deciding: a reading may be as old as a price, not older.
    const bool is_recent = decided_utc_s - record.utc_s <= settings_.guard.price_age_s_max;
    const GuardDecision decision = guard_.decide(
        {.now_utc_s = decided_utc_s,
         .clock_ok = clock_.is_synchronised(),
         .link_ok = record.has_measurement && is_recent,
         .measurement = record.measurement,
         .supervision = supervision_.stop_reason(),
         .cycle_budget_spent = cycle_budget_.is_spent(),
         .barred_direction = reversal_cap_.barred_direction(),
         .previous_power_w = order_.power_w(),
         .has_price = record.price.has_row,
         .price_minute_utc_s = record.price.minute_utc_s,
         .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh,
         .price_is_frozen = frozen_price_.is_no_price(),
         .student_action = record.student_action,
         .held = record.hold.held,
         .held_power_w = record.hold.power_w,
         .reserve_soc_e4 = record.reserve_soc_e4,
         .full_charge = full_charge_.wish(price.price_centi_eur_per_mwh, price_level_),
         .rules = rules,
         .site = site_range(decided_utc_s, Margin::kWhole)});
    record.reason = cause_of(decision.reason, record.battery_status);
    record.ordered_power_w = decision.power_w;
    reversal_cap_.note(decision.power_w);
    advance_mode(record);
    record.decision_us = elapsed_us(start_ns);
  }

  void note_price(const PriceReport& price) {
    price_level_.observe(price.minute_utc_s, price.price_centi_eur_per_mwh);
    frozen_price_.observe(price.minute_utc_s, price.price_centi_eur_per_mwh);
  }

  /// A device that answers, but no longer as the right one, was stopped for what it is, and not because it could not
  /// be read.
  [[nodiscard]] Reason cause_of(Reason reason, Status battery_status) const {
    const Reason found = supervision_.stop_reason();
    const bool is_known = battery_status == Status::kImplausible && is_stop_reason(found);
    return reason == Reason::kLink && is_known ? found : reason;
  }

  /// The tick, unless more than the wait for the price has passed since: a process that was
  /// suspended, or a clock that jumped, must not act on what was new before.
  std::int64_t decision_utc_s(std::int64_t tick_utc_s) const {
    const std::int64_t latest_utc_s = now_utc_s() - settings_.price_wait_s;
    return latest_utc_s > tick_utc_s ? latest_utc_s : tick_utc_s;
  }

  void advance_mode(CycleRecord& record) {
    const bool hold_elapsed = record.utc_s - hold_start_utc_s_ >= settings_.hold_s;
    const Mode before = mode_;
    mode_ = next_mode(mode_, {.stop_requested = clock_.stop_requested(),
                              .stop_reason = is_stop_reason(record.reason),
                              .hold_elapsed = hold_elapsed,
                              .release_now = is_better_released(record.reason),
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
    cut_failed_ = false;
    switch (mode_) {
      case Mode::kRunning:
        write_order(record.ordered_power_w, record, order_.write_until_ns());
        if (record.has_measurement) supervision_.on_ordered(now_utc_s(), record.battery_status);
        break;
      case Mode::kHolding:
        write_order(0, record, order_.write_until_ns());
        break;
      case Mode::kSafe:
        if (order_.exists()) write_release(record);
        break;
      case Mode::kStart:
      case Mode::kStopping:
        break;
    }
    record.write_us = elapsed_us(start_ns);
    if (record.battery_status == Status::kOk) record.battery_status = reading_status;
    const bool fresh = record.price.has_row && record.price.received_monotonic_ns >= request_ns_;
    if (record.written && fresh) {
      record.total_us = elapsed_us(record.price.received_monotonic_ns);
    }
  }

  void write_order(std::int32_t power_w, CycleRecord& record, std::int64_t write_until_ns) {
    note_price_age(now_utc_s(), record);
    record.ordered_power_w = power_w;
    record.battery_status = order_.write(power_w, reserve_soc_e4_, write_until_ns);
    record.written = record.battery_status == Status::kOk;
  }

  void write_release(CycleRecord& record) {
    record.ordered_power_w = 0;
    record.battery_status = order_.release();
    record.written = record.battery_status == Status::kOk;
  }

  /// Late is an order that was needed and not in force `order_deadline_s` after its tick.
  void count_deadline_miss(const CycleRecord& record) {
    const bool needed = settings_.control && (mode_ == Mode::kRunning || mode_ == Mode::kHolding);
    const std::int64_t deadline_s = record.utc_s + settings_.order_deadline_s;
    const bool in_time = clock_.now_utc_ns() <= deadline_s * kNanosecondsPerSecond;
    if (needed && !(record.written && in_time)) ++deadline_misses_;
  }

  void fill_totals(CycleRecord& record) const {
    record.missed_ticks = missed_ticks_;
    record.deadline_misses = deadline_misses_;
    record.unanswered_orders = supervision_.response().unanswered_orders();
    record.weak_answers = supervision_.response().weak_answers();
    record.findings = supervision_.response().findings();
    record.replaced_orders = supervision_.lost_orders().replaced();
    record.ended_orders = supervision_.lost_orders().ended();
    record.lost_orders = supervision_.lost_orders().history();
    record.is_tripped = supervision_.trip().is_set();
    record.trip = supervision_.trip();
    record.throughput = cycle_budget_.today();
    record.reversals = reversal_cap_.history();
    record.price_level = price_level_;
    record.standing_price = frozen_price_.price();
    record.price_frozen = frozen_price_.is_told();
    record.days_since_full = full_charge_.days_since_full();
    record.site = site_.report(record.utc_s);
    record.site.order_cuts = order_cuts_;
    record.counters = battery_.counters();
  }

  std::int32_t elapsed_us(std::int64_t start_ns) {
    return static_cast<std::int32_t>((clock_.monotonic_ns() - start_ns) / 1'000);
  }

  ControlSettings settings_;
  Battery& battery_;
  PriceSource& prices_;
  Clock& clock_;
  Site site_;
  SafetyGuard guard_;
  CycleBudget cycle_budget_;
  ReversalCap reversal_cap_;
  FullCharge full_charge_;
  const HoldMailbox* holds_ = nullptr;
  std::int32_t reserve_soc_e4_ = 0;  ///< of this hour; 0 = none
  PriceLevel price_level_;
  FrozenPrice frozen_price_;
  Supervision supervision_;
  RecalledTime recalled_time_;
  Mode mode_ = Mode::kStart;
  std::int64_t cycle_ = 0;
  std::int64_t last_tick_utc_s_ = 0;
  std::int64_t hold_start_utc_s_ = 0;
  std::int64_t request_ns_ = 0;  ///< when this cycle asked for its price
  std::int32_t missed_ticks_ = 0;
  std::int32_t deadline_misses_ = 0;
  BatteryMeasurement measured_;   ///< the last that was read at a tick
  std::int64_t site_utc_ns_ = 0;  ///< when the site was last looked at
  std::int32_t order_cuts_ = 0;   ///< since start, between two ticks
  bool cut_failed_ = false;       ///< since this tick: the battery may still follow more
  bool was_cut_ = false;          ///< since the last tick's reading
  OrderInForce<Battery, Clock> order_;
};

}  // namespace bess
