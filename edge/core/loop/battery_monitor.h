// Battery watch: reads battery and site for a cycle, and checks them between two. It refreshes the
// watchdog as often as the map asks, and cuts an order that the site no longer allows. Only a tick
// restores the power.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/core/control/safety_guard.h"
#include "edge/core/control/tick.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/loop/cycle_parts.h"
#include "edge/core/loop/order_in_force.h"

namespace bess {

template <typename Battery, typename Clock, typename Site>
class BatteryMonitor {
 public:
  using Order = OrderInForce<Battery, Clock>;
  using Parts = CycleParts<Site>;

  /// All references belong to the loop and outlive this object.
  BatteryMonitor(const ControlSettings& settings, Battery& battery, Clock& clock, Order& order,
                 Parts& parts, const SafetyGuard& guard, const Mode& mode)
      : settings_(settings),
        battery_(battery),
        clock_(clock),
        order_(order),
        parts_(parts),
        guard_(guard),
        mode_(mode) {}
  BatteryMonitor(const BatteryMonitor&) = delete;
  BatteryMonitor& operator=(const BatteryMonitor&) = delete;

  /// For a cycle, or for the last record of a run.
  void read(ReadingPurpose purpose, CycleRecord& record) {
    record.battery_status = battery_.read(record.measurement);
    record.has_measurement = record.battery_status == Status::kOk;
    if (record.has_measurement) {
      measured_ = record.measurement;
      order_.find(record.measurement);
    }
    const Response response = order_.response(record.measurement);
    observe(purpose, record.utc_s, record.battery_status, response);
    if (!record.has_measurement) {
      record.measurement = {.lost_point = record.measurement.lost_point};
    } else if (settings_.control) {
      record.followed = {.is_judged = response.is_driven && !was_cut_,
                         .power_w = response.ordered_power_w,
                         .age_s = response.order_age_s,
                         .soc_floor_e4 = static_cast<std::int16_t>(response.soc_floor_e4)};
      was_cut_ = false;
    }
  }

  /// Time of the next site check; never if there is nothing to check.
  [[nodiscard]] std::int64_t check_due_utc_ns() const {
    const std::int32_t interval_s = site().check_every_s();
    if (interval_s <= 0) return INT64_MAX;
    const std::int64_t now_ns = clock_.now_utc_ns();
    if (looked_utc_ns_ > now_ns) return now_ns;  // the clock was stepped back
    return looked_utc_ns_ + interval_s * kNanosecondsPerSecond;
  }

  /// Is the order in force still allowed?
  void check() {
    BatteryMeasurement measurement;
    Status status = site().needs_battery() ? battery_.read(measurement) : Status::kNotConnected;
    observe(ReadingPurpose::kCheck, utc_seconds(clock_), status, order_.response(measurement));
    bool is_read = status == Status::kOk;
    if (!settings_.control || !order_.exists() || mode_ != Mode::kRunning) return;
    const BatteryMeasurement& known = is_read ? measurement : measured_;
    if (allowed_order(known, Margin::kHalf).power_w == order_.power_w() && !cut_failed_) return;
    const AllowedOrder left = allowed_order(known, Margin::kWhole);
    if (!site().needs_battery()) is_read = battery_.read(measurement) == Status::kOk;
    // A lost order is for the tick to detect; a new order would hide it. Some devices do not report
    // an order of 0 W: nothing to hide.
    const bool has_ended = measurement.order_ended && order_.drives();
    if (is_read && (measurement.order_replaced || has_ended)) return;
    // At the next reading, energy that flowed so far would be assigned to the next order.
    if (is_read)
      observe(ReadingPurpose::kCut, utc_seconds(clock_), Status::kOk, order_.response(measurement));
    cut(left);
  }

  /// New order at this tick.
  void forget_failed_cut() { cut_failed_ = false; }
  /// Orders cut between two ticks, since start.
  [[nodiscard]] std::int32_t order_cuts() const { return order_cuts_; }

 private:
  [[nodiscard]] const Site& site() const { return parts_.template get<SitePart<Site>>().site; }

  void observe(ReadingPurpose purpose, std::int64_t utc_s, Status status,
               const Response& response) {
    parts_.observe({.purpose = purpose,
                    .utc_s = utc_s,
                    .status = status,
                    .is_read = status == Status::kOk,
                    .is_under_control = settings_.control,
                    .holds_nothing = !order_.exists(),
                    .drives = order_.drives(),
                    .response = response});
    if (purpose == ReadingPurpose::kTick || purpose == ReadingPurpose::kCheck)
      looked_utc_ns_ = clock_.now_utc_ns();
  }

  struct AllowedOrder {
    std::int32_t power_w = 0;
    std::int32_t reserve_soc_e4 = 0;
  };

  /// Limits of the order in force.
  [[nodiscard]] AllowedOrder allowed_order(const BatteryMeasurement& measurement, Margin margin) {
    GuardInputs in{.now_utc_s = utc_seconds(clock_),
                   .measurement = measurement,
                   .previous_power_w = order_.power_w()};
    CycleRecord between;  // belongs to no cycle
    parts_.put({.is_tick = false, .margin = margin}, between, in);
    return {.power_w = guard_.rechecked_power_w(in), .reserve_soc_e4 = in.reserve_soc_e4};
  }

  /// Expires with the readings that caused it, and at the latest with its cycle's order.
  void cut(const AllowedOrder& left) {
    if (left.power_w != order_.power_w()) ++order_cuts_;
    was_cut_ = true;
    const std::int64_t write_until_ns =
        clock_.monotonic_ns() + settings_.order_deadline_s * kNanosecondsPerSecond;
    const Status status = order_.write(left.power_w, left.reserve_soc_e4,
                                       std::min(order_.feed_until_ns(), write_until_ns));
    cut_failed_ = status != Status::kOk;  // reported by the next cycle's record
    parts_.note(left.power_w);
  }

  const ControlSettings& settings_;
  Battery& battery_;
  Clock& clock_;
  Order& order_;
  Parts& parts_;
  const SafetyGuard& guard_;
  const Mode& mode_;
  BatteryMeasurement measured_;     ///< at the last tick
  std::int64_t looked_utc_ns_ = 0;  ///< time of the last site check
  std::int32_t order_cuts_ = 0;
  bool cut_failed_ = false;  ///< since this tick: the battery may still follow a larger order
  bool was_cut_ = false;     ///< since the last tick's reading
};

}  // namespace bess
