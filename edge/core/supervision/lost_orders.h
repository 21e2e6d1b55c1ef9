// Lost orders: set points replaced or ended before their time, found at read-back. Each counts
// once, in a leaky count, so that intermittent losses are found too (leaky_count.h). Losses that
// are no fault do not count:
//
//   0 W that ended, and no power flows                     the battery rests, as ordered
//   charging that ended near full, discharging near empty  nothing left to do
//   alarm, off-grid, charging in the cold                  the device's own safety
//   expired, link lost, released                           distinguished by the driver
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "edge/core/control/control_types.h"
#include "edge/core/supervision/leaky_count.h"
#include "edge/core/supervision/response.h"
#include "shared/units_and_limits.h"

namespace bess {

class LostOrders {
 public:
  static constexpr std::int64_t kForgottenAfterS = 2 * 3'600;
  static constexpr std::int64_t kInsistsForS = 3'600;
  static constexpr std::int32_t kOrdersToSettle = 10;

  explicit LostOrders(const ResponseSettings& settings) : settings_(settings) {}

  /// `follows_another`: no order of ours is in force, and the battery follows another one.
  void observe(const Response& now, bool follows_another) {
    if (lost_s_ != 0 && now.steady_s - lost_s_ > kForgottenAfterS) forget_old();
    const OrderOutcome outcome = follows_another ? OrderOutcome::kReplaced : outcome_of_order(now);
    if (is_lost(now.measurement)) lost_order_ = now.order_number;
    was_lost_ = outcome == OrderOutcome::kReplaced || outcome == OrderOutcome::kEnded;
    if (was_lost_) {
      count_loss(now, outcome);
    } else if (outcome == OrderOutcome::kHolds) {
      count_.good();
      history_.note(false);
      if (++held_ >= kOrdersToSettle) settle();
    }
  }

  /// Release is due: the newest order was lost, and others before it. With `yields` false an hour
  /// of retries comes first, and continues while less than half is lost.
  [[nodiscard]] bool is_to_be_given_up(std::int64_t steady_s, bool yields) const {
    if (!was_lost_ || !count_.is_found()) return false;
    const bool most = 2 * history_.lost >= history_.judged;
    return yields || (most && steady_s - first_lost_s_ >= kInsistsForS);
  }
  /// kOtherMaster if an overwritten register was seen, else kNoAnswer.
  [[nodiscard]] Reason reason() const {
    return was_replaced_ ? Reason::kOtherMaster : Reason::kNoAnswer;
  }
  /// Enough orders have held since the last loss.
  [[nodiscard]] bool has_settled() const { return first_lost_s_ == 0; }

  /// The battery was released: detection restarts here.
  void forget_findings() {
    count_.forget();
    was_replaced_ = was_lost_ = false;
  }

  [[nodiscard]] const LostOrderHistory& history() const { return history_; }
  /// History of an earlier run, from its log; `utc_s`: time of the record.
  void restore(const LostOrderHistory& logged, std::int64_t utc_s) {
    constexpr int kMost = LostOrderHistory::kRemembered;
    for (int i = std::clamp<int>(logged.judged, 0, kMost) - 1; i >= 0; --i) {
      const bool lost = (logged.orders >> i & 1U) != 0;
      history_.note(lost);
      if (lost) {
        count_.bad();
      } else {
        count_.good();
      }
      if (lost && first_lost_s_ == 0) first_lost_s_ = utc_s - (i + 1) * kSecondsPerStep;
    }
    lost_s_ = utc_s;
    history_.is_found = logged.is_found;
  }
  /// Since start.
  [[nodiscard]] std::int32_t replaced() const { return replaced_; }
  [[nodiscard]] std::int32_t ended() const { return ended_; }

 private:
  enum class OrderOutcome : std::uint8_t { kNothingToSee, kHolds, kReplaced, kEnded };

  /// Distance from the ends of the ordered SoC range at which a battery may be done.
  static constexpr std::int32_t kDoneBelowCeilingE4 = 500;
  static constexpr std::int32_t kDoneAboveFloorE4 = 1'000;

  static bool is_lost(const BatteryMeasurement& m) { return m.order_replaced || m.order_ended; }

  [[nodiscard]] OrderOutcome outcome_of_order(const Response& now) const {
    const BatteryMeasurement& m = now.measurement;
    if (m.alarm || m.off_grid) return OrderOutcome::kNothingToSee;
    const bool is_counted = is_lost(m) && now.order_number == lost_order_;
    if (is_counted) return OrderOutcome::kNothingToSee;
    if (m.order_replaced) return OrderOutcome::kReplaced;
    if (m.order_ended) return is_done(now) ? OrderOutcome::kNothingToSee : OrderOutcome::kEnded;
    return now.is_driven && moves(now.ordered_power_w) ? OrderOutcome::kHolds
                                                       : OrderOutcome::kNothingToSee;
  }

  [[nodiscard]] bool moves(std::int32_t power_w) const {
    return std::abs(std::int64_t{power_w}) >
           std::max(settings_.band.tolerance_w, settings_.power_w / 40);
  }

  [[nodiscard]] bool is_done(const Response& now) const {
    const BatteryMeasurement& m = now.measurement;
    if (!moves(now.ordered_power_w)) return !moves(m.power_w);
    if (now.ordered_power_w < 0) {
      return m.soc_e4 <= now.soc_floor_e4 + kDoneAboveFloorE4 || !moves(m.discharge_w_max);
    }
    return m.soc_e4 >= now.soc_ceiling_e4 - kDoneBelowCeilingE4 || !moves(m.charge_w_max) ||
           m.temperature_min_deci_c < kColdDeciC;
  }

  void settle() {
    first_lost_s_ = 0;
    history_.is_found = false;
  }

  void count_loss(const Response& now, OrderOutcome outcome) {
    count_.bad();
    history_.note(true);
    history_.is_found = history_.is_found || count_.is_found();
    held_ = 0;
    lost_s_ = now.steady_s;
    if (first_lost_s_ == 0) first_lost_s_ = now.steady_s;
    was_replaced_ = was_replaced_ || outcome == OrderOutcome::kReplaced;
    std::int32_t& lost = outcome == OrderOutcome::kReplaced ? replaced_ : ended_;
    ++lost;
  }

  void forget_old() {
    forget_findings();
    history_ = {};
    lost_s_ = 0;
  }

  ResponseSettings settings_;
  LeakyCount count_;
  LostOrderHistory history_;
  bool was_lost_ = false;          ///< at the newest reading
  bool was_replaced_ = false;      ///< at least one of the counted ones
  std::int64_t lost_order_ = -1;   ///< number of the newest lost order
  std::int64_t lost_s_ = 0;        ///< time of the last loss; 0 = long ago
  std::int64_t first_lost_s_ = 0;  ///< first loss since orders settled; 0 = settled
  std::int32_t held_ = 0;          ///< consecutive orders held since then
  std::int32_t replaced_ = 0;
  std::int32_t ended_ = 0;
};

}  // namespace bess
