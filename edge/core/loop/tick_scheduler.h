// Waits of a control cycle: for its tick, for the price of the previous minute, for the end of its
// step. The battery is watched while waiting. Every wait has a deadline and ends when the clock is
// stepped back.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/core/control/tick.h"
#include "edge/core/loop/battery_monitor.h"
#include "edge/core/loop/control_settings.h"

namespace bess {

template <typename Battery, typename PriceSource, typename Clock, typename Site>
class TickScheduler {
 public:
  using Watch = BatteryMonitor<Battery, Clock, Site>;

  TickScheduler(const ControlSettings& settings, PriceSource& prices, Clock& clock,
                OrderInForce<Battery, Clock>& order, Watch& watch)
      : settings_(settings), prices_(prices), clock_(clock), order_(order), watch_(watch) {}
  TickScheduler(const TickScheduler&) = delete;
  TickScheduler& operator=(const TickScheduler&) = delete;

  /// Sleeps until `read_lead_s` before the next tick; false on a stop request. After a clock step
  /// backwards the next tick is another one.
  bool await_next_tick(std::int64_t& tick_utc_s) {
    do {
      tick_utc_s = next_tick_utc_s(utc_seconds(clock_));
      if (!sleep_until_s(tick_utc_s - settings_.read_lead_s)) return false;
    } while (utc_seconds(clock_) < tick_utc_s - kSecondsPerStep - settings_.read_lead_s);
    count_missed(tick_utc_s);
    return true;
  }
  [[nodiscard]] std::int32_t missed_ticks() const { return missed_ticks_; }

  bool sleep_until_tick() { return sleep_until_s(tick_utc_s_); }
  /// The last order lasts its whole step.
  void finish_step() { sleep_until_s(tick_utc_s_ + kSecondsPerStep); }

  /// Requests the price of the minute before the tick.
  void request_price() {
    request_ns_ = clock_.monotonic_ns();
    prices_.request(tick_utc_s_ - 60,
                    bounded_monotonic_ns(clock_, tick_utc_s_, settings_.read_lead_s),
                    price_deadline_ns());
  }
  /// In slices, so that a stop request is noticed.
  PriceReport await_price() {
    constexpr std::int64_t kSliceNs = kNanosecondsPerSecond / 10;
    const std::int64_t deadline_ns = price_deadline_ns();
    while (!clock_.stop_requested()) {
      const std::int64_t now_ns = clock_.monotonic_ns();
      if (now_ns >= deadline_ns) break;
      if (clock_.now_utc_ns() >= order_.refresh_due_utc_ns()) order_.refresh();
      if (prices_.wait(std::min(now_ns + kSliceNs, deadline_ns))) break;
    }
    return prices_.latest();
  }
  /// Received by this cycle's own request.
  [[nodiscard]] bool is_fresh(const PriceReport& price) const {
    return price.has_row && price.received_monotonic_ns >= request_ns_;
  }

 private:
  bool sleep_until_s(std::int64_t utc_s) { return sleep_until_ns(utc_s * kNanosecondsPerSecond); }

  /// False on a stop request. Returns early when the clock was stepped back: the instant may now be
  /// hours ahead.
  bool sleep_until_ns(std::int64_t until_ns) {
    while (true) {
      const std::int64_t before_ns = clock_.now_utc_ns();
      const std::int64_t refresh_ns = order_.refresh_due_utc_ns();
      const std::int64_t due_ns = std::min(refresh_ns, watch_.check_due_utc_ns());
      if (due_ns >= until_ns) return clock_.sleep_until_utc_ns(until_ns);
      if (!clock_.sleep_until_utc_ns(due_ns)) return false;
      refresh_ns == due_ns ? order_.refresh() : watch_.check();
      if (clock_.now_utc_ns() < before_ns) return true;
    }
  }

  void count_missed(std::int64_t tick_utc_s) {
    if (tick_utc_s_ != 0 && tick_utc_s > tick_utc_s_ + kSecondsPerStep) {
      missed_ticks_ += static_cast<std::int32_t>((tick_utc_s - tick_utc_s_) / kSecondsPerStep - 1);
    }
    tick_utc_s_ = tick_utc_s;
  }

  [[nodiscard]] std::int64_t price_deadline_ns() const {
    return bounded_monotonic_ns(clock_, tick_utc_s_ + settings_.price_wait_s,
                                settings_.price_wait_s + settings_.read_lead_s);
  }

  const ControlSettings& settings_;
  PriceSource& prices_;
  Clock& clock_;
  OrderInForce<Battery, Clock>& order_;
  Watch& watch_;
  std::int64_t tick_utc_s_ = 0;  ///< of this cycle, or the last
  std::int64_t request_ns_ = 0;  ///< time of this cycle's price request
  std::int32_t missed_ticks_ = 0;
};

}  // namespace bess
