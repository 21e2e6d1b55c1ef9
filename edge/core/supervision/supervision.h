// Supervision result: trip until cleared, or pause with retries at growing intervals. Only what was
// measured counts.
//
//   trip    wrong direction, uncontrolled power, SoC against power   until `bess-edge clear`
//   pause   no answer, failing orders, another controller, a         10 min, doubling to 6 h
//           self-protecting battery (a trip if it never ends)
//   stop    capacity of another battery, jump of the SoC             while it is present
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "edge/core/control/control_types.h"
#include "edge/core/supervision/lost_orders.h"
#include "edge/core/supervision/response_monitor.h"

namespace bess {

/// No retry before its end; its length doubles until a success.
class Pause {
 public:
  static constexpr std::int64_t kFirstS = 600;
  static constexpr std::int64_t kLongestS = 6 * 3'600;

  void begin(std::int64_t utc_s, Reason reason) {
    reason_ = reason;
    end_utc_s_ = utc_s + length_s_;
    length_s_ = std::min(2 * length_s_, kLongestS);
  }
  /// A clock step backwards does not extend it.
  [[nodiscard]] bool is_over(std::int64_t utc_s) const {
    return utc_s >= end_utc_s_ || utc_s < end_utc_s_ - kLongestS;
  }
  /// Present while it lasts.
  [[nodiscard]] std::optional<Reason> reason() const { return reason_; }
  /// Its cause is still present.
  void prolong(std::int64_t utc_s) { end_utc_s_ = std::max(end_utc_s_, utc_s + kFirstS); }
  void end() { reason_.reset(); }
  void on_success() { length_s_ = kFirstS; }

 private:
  std::optional<Reason> reason_;
  std::int64_t end_utc_s_ = 0;
  std::int64_t length_s_ = kFirstS;
};

struct SupervisionSettings {
  ResponseSettings response{};
  std::int32_t capacity_wh_min = 0;  ///< accepted range of a reported capacity
  std::int32_t capacity_wh_max = INT32_MAX;
  bool yields_to_other_master = true;  ///< false: insists
};

class Supervision {
 public:
  static constexpr std::int32_t kFailedOrdersToPause = 3;
  static constexpr std::int32_t kUnreadToPause = 6;
  /// Longer than any self-protection or cell balancing.
  static constexpr std::int64_t kCareWithoutEndS = 24 * 3'600;

  explicit Supervision(const SupervisionSettings& settings)
      : settings_(settings), response_(settings.response), lost_(settings.response) {}

  /// Each reading at the end of a step. `holds_nothing`: no order of ours is in force.
  void observe(const Response& now, bool holds_nothing) {
    note_capacity(now.measurement.capacity_wh);
    end_pause(now.utc_s);
    if (trip_) return;
    if (now.is_driven && now.ordered_power_w != 0) unread_ = 0;
    observe_orders(now, holds_nothing);
    judge(now);
  }

  /// A logged reading of an earlier run, oldest first: reproduces its findings.
  void recall(const Response& then) {
    end_pause(then.utc_s);
    if (!trip_) judge(then);
  }

  /// The reported capacity, also when nothing else could be read; 0 or less: not reported.
  void note_capacity(std::int32_t capacity_wh) {
    capacity_fits_ = capacity_wh <= 0 || (capacity_wh >= settings_.capacity_wh_min &&
                                          capacity_wh <= settings_.capacity_wh_max);
  }

  /// A reading within a step, just before the order changes: only recorded.
  void note_power(const Response& now) { response_.note_power(now); }
  /// Any other reading within a step.
  void note_between(const Response& now) {
    if (trip_) return;
    response_.note_between(now);
    trip_if_found(now);
  }

  /// Result of an order that was due, with the battery reachable.
  void on_ordered(std::int64_t utc_s, Status status) {
    // The daily flash write limit is our own rule, not a link fault.
    const bool failed = status != Status::kOk && status != Status::kWriteBudget;
    failed_orders_ = failed ? failed_orders_ + 1 : 0;
    if (failed_orders_ >= kFailedOrdersToPause) pause(utc_s, Reason::kOrdersFail);
  }

  /// A failed reading at the end of a step. Failures with every order but not at 0 W are caused by
  /// orders; random link failures need more of them.
  void note_unread(std::int64_t utc_s, bool was_driven, bool is_temporary) {
    unread_ = was_driven ? unread_ + (is_temporary ? 1 : kUnreadToPause / 2) : 0;
    if (unread_ >= kUnreadToPause && !trip_) pause(utc_s, Reason::kOrdersFail);
  }

  /// Reason not to drive the battery now.
  [[nodiscard]] std::optional<Reason> stop_reason() const {
    if (trip_) return trip_->reason;
    if (pause_.reason()) return pause_.reason();
    if (!capacity_fits_) return Reason::kCapacity;
    if (response_.has_jumped()) return Reason::kSocJump;
    return std::nullopt;
  }

  [[nodiscard]] const std::optional<Trip>& trip() const { return trip_; }
  /// Trip of an earlier run, from its log.
  void restore(const std::optional<Trip>& trip) { trip_ = trip; }
  void clear() {
    trip_.reset();
    response_.clear();
  }
  [[nodiscard]] const ResponseMonitor& response() const { return response_; }
  [[nodiscard]] const LostOrders& lost_orders() const { return lost_; }
  /// Findings of an earlier run, from its log; none of a trip that was cleared.
  void restore(const ResponseFindings& logged) { response_.restore(logged); }
  /// History of an earlier run, from its log at `utc_s`.
  void restore(const LostOrderHistory& orders, std::int64_t utc_s) { lost_.restore(orders, utc_s); }

 private:
  void judge(const Response& now) {
    response_.observe(now);
    if (response_.needs_no_care()) care_since_s_ = 0;
    trip_if_found(now);
    if (trip_) return;
    if (response_.gives_no_answer()) {
      pause(now.utc_s, Reason::kNoAnswer);
    } else if (response_.looks_after_itself()) {
      pause_for_care(now);
    } else if (response_.has_answered() && lost_.has_settled() && failed_orders_ == 0) {
      pause_.on_success();
    }
  }
  void trip_if_found(const Response& now) {
    if (const auto found = response_.trip()) trip_ = Trip{.reason = *found, .utc_s = now.utc_s};
  }
  void pause(std::int64_t utc_s, Reason reason) {
    pause_.begin(utc_s, reason);
    lost_.forget_findings();
    failed_orders_ = 0;
    unread_ = 0;
    response_.forget();
  }
  /// A short pause, repeated as often as needed: the price may require the battery.
  void pause_for_care(const Response& now) {
    pause_.on_success();
    pause(now.utc_s, Reason::kBatteryCare);
    if (care_since_s_ == 0) care_since_s_ = now.steady_s;
    if (now.steady_s - care_since_s_ < kCareWithoutEndS) return;
    trip_ = Trip{.reason = Reason::kUncontrolledPower, .utc_s = now.utc_s};
  }
  void end_pause(std::int64_t utc_s) {
    if (pause_.reason() && pause_.is_over(utc_s)) pause_.end();
  }

  /// With `yields_to_other_master` false, orders of others are ignored while none of ours is in
  /// force.
  void observe_orders(const Response& now, bool holds_nothing) {
    const bool yields = settings_.yields_to_other_master;
    const bool follows_another = yields && holds_nothing && now.measurement.dispatch_active;
    if (follows_another && pause_.reason() == Reason::kOtherMaster) {
      return pause_.prolong(now.utc_s);
    }
    lost_.observe(now, follows_another);
    if (lost_.is_to_be_given_up(now.steady_s, yields)) pause(now.utc_s, lost_.reason());
  }

  SupervisionSettings settings_;
  ResponseMonitor response_;
  std::optional<Trip> trip_;
  Pause pause_;
  bool capacity_fits_ = true;
  LostOrders lost_;
  std::int64_t care_since_s_ = 0;  ///< no healthy reading since; 0 = no care needed
  std::int32_t failed_orders_ = 0;
  std::int32_t unread_ = 0;  ///< points for orders during which the battery cannot be read
};

}  // namespace bess
