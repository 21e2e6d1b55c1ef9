// Order that the battery follows or may follow: found after a restart, written, refreshed, bound to
// its tick, released. Battery and Clock as in control_loop.h.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/core/control/control_types.h"
#include "edge/core/control/power_order.h"
#include "edge/core/control/tick.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/supervision/response.h"

namespace bess {

/// Time at which this power was first ordered, to a few seconds: the battery is read shortly before
/// its tick.
inline std::int64_t ordered_since_utc_s(const CycleRecord& record) {
  const FollowedOrder& before = record.followed;
  const bool goes_on = before.is_judged && before.power_w == record.ordered_power_w;
  return goes_on ? record.utc_s - before.age_s : record.utc_s;
}

template <typename Battery, typename Clock>
class OrderInForce {
 public:
  OrderInForce(const ControlSettings& settings, Battery& battery, Clock& clock)
      : settings_(settings),
        battery_(battery),
        clock_(clock),
        time_(clock),
        soc_floor_e4_(settings.guard.soc_min_e4) {}
  OrderInForce(const OrderInForce&) = delete;
  OrderInForce& operator=(const OrderInForce&) = delete;

  /// An order may be in force at the battery.
  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] std::int32_t age_s() const {
    return static_cast<std::int32_t>(time_.now_s() - since_s_);
  }
  [[nodiscard]] std::int32_t power_w() const { return power_w_; }
  [[nodiscard]] bool drives() const { return exists_ && power_w_ != 0; }
  /// The first reading has shown whether an earlier run left an order in force.
  [[nodiscard]] bool has_looked() const { return has_looked_; }
  [[nodiscard]] bool was_found() const { return was_found_; }
  /// Monotonic deadlines of this cycle's order.
  [[nodiscard]] std::int64_t write_until_ns() const { return write_until_ns_; }
  [[nodiscard]] std::int64_t feed_until_ns() const { return feed_until_ns_; }

  /// After a restart the battery may still follow the previous run's order. It continues until the
  /// first decision, and from now on this run holds and releases it.
  void find(const BatteryMeasurement& measurement) {
    if (has_looked_) return;
    has_looked_ = true;
    was_found_ = settings_.control && measurement.dispatch_active;
    if (!was_found_) return;
    exists_ = true;
    since_s_ = time_.now_s();
    if (!measurement.has_order_power) return;
    power_w_ = measurement.order_power_w;
    const std::int64_t utc_s = utc_seconds(clock_);
    const bool is_expected = power_w_ == expected_power_w_ && expected_utc_s_ <= utc_s &&
                             utc_s - expected_utc_s_ <= settings_.order_duration_s;
    if (is_expected) since_s_ -= utc_s - expected_since_utc_s_;
  }

  /// The newest logged order of the previous run: if found in force, it keeps its age, and the
  /// battery's response counts.
  void expect(const CycleRecord& newest) {
    expected_power_w_ = newest.ordered_power_w;
    expected_utc_s_ = newest.utc_s;
    expected_since_utc_s_ = ordered_since_utc_s(newest);
  }

  /// Steady time minus UTC, continued from the recalled log.
  void set_ahead(std::int64_t ahead_s) { time_.set_ahead(ahead_s); }

  /// An order belongs to its tick: a process that was suspended neither writes nor refreshes it
  /// later, because its price is out of date.
  void bind(std::int64_t tick_utc_s) {
    const std::int32_t write_s = settings_.order_deadline_s;
    const std::int32_t feed_s = kSecondsPerStep + settings_.price_wait_s + write_s;
    write_until_ns_ =
        bounded_monotonic_ns(clock_, tick_utc_s + write_s, write_s + settings_.read_lead_s);
    feed_until_ns_ =
        bounded_monotonic_ns(clock_, tick_utc_s + feed_s, feed_s + settings_.read_lead_s);
  }

  Status write(std::int32_t power_w, std::int32_t reserve_soc_e4, std::int64_t write_until_ns) {
    if (!exists_ || power_w != power_w_) since_s_ = time_.now_s();
    exists_ = true;  // even if writing fails: the battery may have received it
    power_w_ = power_w;
    fed_utc_ns_ = clock_.now_utc_ns();
    soc_floor_e4_ = std::max(settings_.guard.soc_min_e4, reserve_soc_e4);
    // 0 W is never too late.
    const bool is_bound = power_w != 0;
    const Status status = battery_.order({.power_w = power_w,
                                          .soc_min_e4 = soc_floor_e4_,
                                          .soc_max_e4 = settings_.guard.soc_max_e4,
                                          .duration_s = settings_.order_duration_s,
                                          .write_until_ns = is_bound ? write_until_ns : INT64_MAX,
                                          .feed_until_ns = is_bound ? feed_until_ns_ : INT64_MAX});
    is_confirmed_ = status == Status::kOk;
    if (is_confirmed_) ++number_;
    return status;
  }

  Status release() {
    power_w_ = 0;
    const Status status = battery_.release();
    if (status == Status::kOk) exists_ = false;
    return status;
  }

  /// Without control: the hypothetical order, as the start of the ramp.
  void imagine(std::int32_t power_w) { power_w_ = power_w; }

  /// Time of the next watchdog refresh; never without a watchdog or an order in force.
  [[nodiscard]] std::int64_t refresh_due_utc_ns() const {
    const std::int32_t interval_s = battery_.refresh_interval_s();
    if (!settings_.control || !exists_ || interval_s <= 0) return INT64_MAX;
    const std::int64_t now_ns = clock_.now_utc_ns();
    if (fed_utc_ns_ > now_ns) return now_ns;  // the clock was stepped back
    return fed_utc_ns_ + interval_s * kNanosecondsPerSecond;
  }

  void refresh() {
    // A failure shows in the counters; the next order finds the cause.
    static_cast<void>(battery_.refresh());
    fed_utc_ns_ = clock_.now_utc_ns();
  }

  /// A response exists only to an order that the battery follows: after a refused or expired order
  /// it is in its own mode, where any power is possible. If the clock was stepped since an earlier
  /// run gave the order, its age is unknown.
  [[nodiscard]] Response response(const BatteryMeasurement& m) const {
    const std::int64_t read_s = time_.now_s();
    const bool is_known = (m.has_order_power || is_confirmed_) && read_s > since_s_;
    return {.utc_s = utc_seconds(clock_),
            .steady_s = read_s,
            .is_driven =
                exists_ && m.dispatch_active && is_known && !m.order_replaced && !m.order_ended,
            .order_number = number_,
            .ordered_power_w = m.has_order_power ? m.order_power_w : power_w_,
            .order_age_s = static_cast<std::int32_t>(read_s - since_s_),
            .soc_floor_e4 = soc_floor_e4_,
            .soc_ceiling_e4 = settings_.guard.soc_max_e4,
            .measurement = m};
  }

 private:
  const ControlSettings& settings_;
  Battery& battery_;
  Clock& clock_;
  SteadyTime<Clock> time_;
  bool exists_ = false;
  std::int32_t power_w_ = 0;
  bool is_confirmed_ = false;    ///< read back
  std::int64_t number_ = 0;      ///< of the confirmed orders
  std::int64_t since_s_ = 0;     ///< steady: when this power was first ordered
  std::int64_t fed_utc_ns_ = 0;  ///< last order or refresh
  std::int32_t soc_floor_e4_;    ///< at which the device itself stops discharging
  std::int64_t write_until_ns_ = 0;
  std::int64_t feed_until_ns_ = 0;
  std::int32_t expected_power_w_ = 0;
  std::int64_t expected_utc_s_ = INT64_MIN / 2;
  std::int64_t expected_since_utc_s_ = INT64_MIN / 2;
  bool has_looked_ = false;
  bool was_found_ = false;
};

}  // namespace bess
