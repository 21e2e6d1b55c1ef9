// Order state in the device: a pure state machine over CLOCK_MONOTONIC instants.
//
//   none --enabled--> enabled --taken--> in force --refreshed, retaken--> in force
//    ^                   |                  |
//    +------ lost -------+------ lost ------+      replaced, ended, expired, refused or released
//
//   none      the device is in its own mode, or follows another order
//   enabled   external control is on, no order yet
//   in force  confirmed by read-back and not ended since; its time runs from the last refresh
#pragma once

#include <cstdint>

#include "edge/core/control/power_order.h"
#include "edge/device/registers/battery_command.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Loss of an order that should be in force.
enum class OrderLoss : std::uint8_t {
  kNone,
  kReplaced,  ///< another client overwrote its registers
  kEnded      ///< the device follows none, and no register shows who ended it
};

class OrderState {
 public:
  /// `watchdog` must outlive this object.
  explicit OrderState(const Watchdog& watchdog) : watchdog_(watchdog) {}

  [[nodiscard]] bool is_enabled() const { return state_ != State::kNone; }
  [[nodiscard]] bool is_in_force() const { return state_ == State::kInForce; }
  /// The device holds our state, or was released by us.
  [[nodiscard]] bool was_ours() const { return was_ours_; }
  [[nodiscard]] OrderLoss loss() const { return loss_; }
  /// Command of the order in force.
  [[nodiscard]] Command command() const { return command_; }
  [[nodiscard]] const PowerOrder& order() const { return order_; }

  void on_enabled() { state_ = State::kEnabled; }
  /// Completely written and confirmed.
  void on_taken(Command command, const PowerOrder& order, std::int64_t now_ns) {
    state_ = State::kInForce;
    was_ours_ = true;
    loss_ = OrderLoss::kNone;
    command_ = command;
    order_ = order;
    since_ns_ = fed_ns_ = now_ns;
    runs_out_ = false;
  }
  /// Same registers, longer validity.
  void on_prolonged(const PowerOrder& order) { order_ = order; }
  void on_fed(std::int64_t now_ns) {
    fed_ns_ = now_ns;
    runs_out_ = false;
  }
  /// The device's own timer, as last read.
  void note_seconds_left(std::int64_t left_s) { runs_out_ = left_s < watchdog_.refresh_s; }
  void on_lost() { state_ = State::kNone; }
  /// An order that has just expired is no loss, unless another client overwrote it.
  void on_lost(OrderLoss loss, bool is_foreign, std::int64_t now_ns) {
    if (is_foreign || is_within_its_time(now_ns)) loss_ = loss;
    on_lost();
  }
  void on_released() {
    on_lost();
    was_ours_ = true;
    loss_ = OrderLoss::kNone;
  }

  /// The device may still follow it.
  [[nodiscard]] bool may_last(std::int64_t now_ns) const {
    return is_in_force() && (never_expires() || now_ns - fed_ns_ < duration_ns());
  }
  /// Refreshed so recently that it cannot have expired; a tenth of its duration is margin for clock
  /// differences.
  [[nodiscard]] bool is_within_its_time(std::int64_t now_ns) const {
    return never_expires() || now_ns - fed_ns_ < duration_ns() - duration_ns() / 10;
  }
  /// Refreshed at half the interval, so that one late refresh does no harm.
  [[nodiscard]] bool is_due(std::int64_t now_ns) const {
    const std::int64_t half_ns = watchdog_.refresh_s * kNanosecondsPerSecond / 2;
    return is_in_force() && !never_expires() && (runs_out_ || now_ns - fed_ns_ >= half_ns);
  }
  /// Some devices confirm an order before they show it.
  [[nodiscard]] bool has_settled(std::int64_t now_ns, std::int32_t settle_s) const {
    return now_ns - since_ns_ >= settle_s * kNanosecondsPerSecond;
  }
  [[nodiscard]] bool never_expires() const { return watchdog_.kind == Watchdog::Kind::kNone; }

 private:
  enum class State : std::uint8_t { kNone, kEnabled, kInForce };

  [[nodiscard]] std::int64_t duration_ns() const {
    return watchdog_.duration_s * kNanosecondsPerSecond;
  }

  const Watchdog& watchdog_;
  State state_ = State::kNone;
  bool was_ours_ = false;
  OrderLoss loss_ = OrderLoss::kNone;  ///< of the newest order
  bool runs_out_ = false;              ///< the device's timer shows less than one refresh interval
  Command command_ = Command::kIdle;
  PowerOrder order_;
  std::int64_t since_ns_ = 0;  ///< when it was completely written
  std::int64_t fed_ns_ = 0;
};

}  // namespace bess
