// Fixed-size records of one control cycle, in the order of the data flow:
//   battery -> BatteryMeasurement, price source -> PriceReport, guard -> GuardDecision, loop ->
//   CycleRecord.
// Power is grid side, positive when the battery charges. Prices are integers in 0.01 EUR/MWh.
#pragma once

#include <bit>
#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/core/control/cycle_budget.h"
#include "edge/core/control/frozen_price.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/outlook.h"
#include "edge/core/control/reasons.h"
#include "edge/core/control/site_types.h"
#include "edge/core/control/tick.h"
#include "shared/action.h"
#include "shared/price_level.h"

namespace bess {

struct BatteryMeasurement {
  std::int32_t soc_e4 = 0;
  std::int32_t power_w = 0;
  std::int32_t capacity_wh = 0;
  std::int32_t charge_w_max = INT32_MAX;  ///< live limits of the device
  std::int32_t discharge_w_max = INT32_MAX;
  std::int32_t temperature_min_deci_c = 200;
  std::int32_t temperature_max_deci_c = 200;
  bool alarm = false;
  bool off_grid = false;
  bool dispatch_active = false;  ///< the device follows a written order
  bool has_order_power = false;  ///< the map can read back the power of the order in force
  std::int32_t order_power_w = 0;
  bool order_replaced = false;    ///< an order register was overwritten by another controller
  bool order_ended = false;       ///< order ended early without a register change
  bool has_grid_power = false;    ///< the map has a grid point, and it was read
  std::int32_t grid_power_w = 0;  ///< import is positive
  bool warning = false;           ///< device warning: reported, no stop
  /// A missing or implausible reading: a required one, or a protective one (alarm, limit,
  /// temperature, off-grid). 1 + its index in the map; 0 = none.
  std::int16_t lost_point = 0;
  std::int16_t cut_point = 0;  ///< as lost_point: a value clamped to its range
  bool grid_unknown = false;   ///< lost_point is the reading of the grid state
};

/// Totals since start, and today's writes to flash registers.
struct BatteryCounters {
  std::int64_t requests = 0;          ///< sent, or not sent for lack of a connection
  std::int64_t failed_requests = 0;   ///< without a good reply
  std::int64_t reconnects = 0;        ///< connections after the first
  std::int64_t register_writes = 0;   ///< write requests that reached the device
  std::int64_t unchanged_orders = 0;  ///< orders already in force: nothing written
  std::int64_t flash_day = 0;         ///< UTC day (since 1970) that the next field counts
  std::int32_t flash_writes_today = 0;
};

/// The newest usable price row and how it was received.
struct PriceReport {
  bool has_row = false;
  std::int64_t minute_utc_s = 0;  ///< start of the minute at whose END the row was computed
  std::int32_t price_centi_eur_per_mwh = 0;
  std::int64_t received_monotonic_ns = 0;
  std::int32_t fetch_us = 0;       ///< duration of its request
  Status status = Status::kNoRow;  ///< of the last request
  bool large_step = false;         ///< the row differs from its predecessor by more than configured
  bool step_held = false;          ///< a newer row does, and awaits a confirming one
  std::int32_t held_centi_eur_per_mwh = 0;  ///< price of that newer row
};

/// Result of the supervision; in force until a person clears it.
struct Trip {
  Reason reason = Reason::kStudent;
  std::int64_t utc_s = 0;
};

/// The order that the battery followed when it was read, so that a later run can judge the reading
/// again.
struct FollowedOrder {
  bool is_judged = false;  ///< followed since the previous reading, not cut by a limit
  std::int32_t power_w = 0;
  std::int32_t age_s = 0;
  std::int16_t soc_floor_e4 = 0;
};

/// Findings of the supervision that are no reason to stop; 0 = none.
struct ResponseFindings {
  std::int16_t energy_share_percent = 0;  ///< share of the measured energy that shows in the SoC
  std::int32_t rest_loss_w = 0;           ///< loss at 0 W, or in addition to orders; negative: gain
  std::int32_t ramp_w_per_s = 0;          ///< ramp after an order, too slow for the map
  std::int16_t locked_readings = 0;       ///< consecutive readings whose own limits permit no power
  std::int32_t wrong_energy_e6 = 0;  ///< energy against or beyond orders, share of the capacity
};

/// Lost orders among the newest orders with power. Logged, so that a restart continues the count;
/// shown by status, health and metrics.
struct LostOrderHistory {
  static constexpr int kRemembered = 30;  ///< one hour

  std::uint32_t orders = 0;  ///< one bit per order, 1 = lost, newest in the lowest bit
  std::int16_t judged = 0;   ///< number of valid bits, 0..30
  std::int16_t lost = 0;     ///< lost orders among them
  bool is_found = false;     ///< finding: too many, and no long enough series held since

  constexpr void note(bool is_lost) {
    constexpr std::uint32_t kMask = (1U << kRemembered) - 1;
    orders = (orders << 1 | (is_lost ? 1U : 0U)) & kMask;
    if (judged < kRemembered) ++judged;
    lost = static_cast<std::int16_t>(std::popcount(orders));
  }
  friend constexpr bool operator==(const LostOrderHistory&, const LostOrderHistory&) = default;
};

struct GuardDecision {
  std::int32_t power_w = 0;
  Reason reason = Reason::kLink;
};

/// One control cycle, for the log. Names ending in _us are wall-clock microseconds.
struct CycleRecord {
  std::int64_t utc_s = 0;
  std::int64_t cycle = 0;
  Mode mode = Mode::kStart;
  bool has_measurement = false;
  BatteryMeasurement measurement{};
  PriceReport price{};
  /// Time since the end of the row's minute, at the decision or at a later write of the order.
  std::int32_t price_age_s = -1;  ///< -1 = no price
  bool has_student_action = false;
  Action student_action = Action::kIdle;
  std::int32_t ordered_power_w = 0;
  Reason reason = Reason::kLink;
  Status battery_status = Status::kNotConnected;  ///< worst battery call of this cycle
  bool written = false;                           ///< an order or a release was sent and read back
  std::int32_t decision_us = 0;
  std::int32_t write_us = 0;         ///< order written and read back
  std::int32_t total_us = 0;         ///< from arrival of the price row to read-back
  std::int32_t missed_ticks = 0;     ///< ticks since start skipped because a cycle overran
  std::int32_t deadline_misses = 0;  ///< cycles since start whose order was late
  /// Consecutive orders without a power response.
  std::int32_t unanswered_orders = 0;
  DayThroughput throughput{};
  BatteryCounters counters{};
  PriceLevel price_level{};        ///< including the prices of this cycle
  std::int16_t context_class = 0;  ///< input of the student, 1..12; 0 = no decision
  bool is_tripped = false;
  Trip trip{};                       ///< where is_tripped
  std::int32_t weak_answers = 0;     ///< consecutive readings with less power than ordered
  std::int32_t replaced_orders = 0;  ///< orders replaced by another controller, since start
  ReversalHistory reversals{};       ///< including this cycle's order
  HoldReport hold{};
  std::int16_t reserve_soc_e4 = 0;   ///< reserve at the tick; 0 = none
  std::int16_t days_since_full = 0;  ///< local days since the SoC was last full
  SiteReport site{};
  std::int32_t ended_orders = 0;  ///< orders ended early without a register change, since start
  LostOrderHistory lost_orders{};
  UnchangedPrice standing_price{};
  bool price_frozen = false;  ///< unchanged for longer than the reporting threshold
  ResponseFindings findings{};
  FollowedOrder followed{};
  OutlookReport outlook{};
  bool price_stands_in = false;  ///< decided on an estimate: the newest price is too old
  std::int32_t stand_in_centi_eur_per_mwh = 0;
};

/// Price on which student, rules and thresholds decided; for a record with a price.
constexpr std::int32_t decided_price_centi(const CycleRecord& record) {
  return record.price_stands_in ? record.stand_in_centi_eur_per_mwh
                                : record.price.price_centi_eur_per_mwh;
}

}  // namespace bess
