// The fixed-size records that flow through one cycle of the controller, in their order:
//   battery -> BatteryMeasurement, price source -> PriceReport, guard -> GuardDecision, loop ->
//   CycleRecord.
// Power is grid side and positive when the battery charges; prices are integer hundredths of
// EUR/MWh.
#pragma once

#include <cstdint>
#include <iterator>
#include <string_view>

#include "edge/core/base/status.h"
#include "edge/core/control/cycle_budget.h"
#include "edge/core/control/frozen_price.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/lost_order_history.h"
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
  bool dispatch_active = false;  ///< the device follows an order that was written to it
  bool has_order_power = false;  ///< the map can read back the power of the order in force
  std::int32_t order_power_w = 0;
  bool order_replaced = false;    ///< a register of our order holds what somebody else wrote
  bool order_ended = false;       ///< our order is gone before its end, and nobody's hand shows
  bool has_grid_power = false;    ///< the map has a grid point, and it was asked for
  std::int32_t grid_power_w = 0;  ///< import is positive
  bool warning = false;           ///< the device warns and goes on: told, stops nothing
  /// A reading that did not come or is not plausible: one without which nothing is measured, or a
  /// protective one (alarm, limit, temperature, off-grid). 1 + its index in the map; 0 = none.
  std::int16_t lost_point = 0;
  std::int16_t cut_point = 0;  ///< likewise one that is beyond its range and was cut to it
  bool grid_unknown = false;   ///< of these, the one that tells whether the grid is there
};

/// Totals since start, and what the flash-backed registers have had today.
struct BatteryCounters {
  std::int64_t requests = 0;
  std::int64_t failed_requests = 0;
  std::int64_t reconnects = 0;
  std::int64_t register_writes = 0;   ///< write requests that reached the device
  std::int64_t unchanged_orders = 0;  ///< orders that were in force already and cost no write
  std::int64_t flash_day = 0;         ///< UTC day (since 1970) that the next field counts
  std::int32_t flash_writes_today = 0;
};

/// The newest usable price row and how it came in.
struct PriceReport {
  bool has_row = false;
  std::int64_t minute_utc_s = 0;  ///< start of the minute at whose END the row was computed
  std::int32_t price_centi_eur_per_mwh = 0;
  std::int64_t received_monotonic_ns = 0;
  std::int32_t fetch_us = 0;       ///< wall time of the request that brought it
  Status status = Status::kNoRow;  ///< of the last request
  bool large_step = false;         ///< the row lies further from its predecessor than configured
  bool step_held = false;          ///< a newer row does, and waits for one that confirms it
  std::int32_t held_centi_eur_per_mwh = 0;  ///< price of that newer row
};

/// Found by the supervision of the battery's answers; in force until a person clears it.
struct Trip {
  Reason reason = Reason::kStudent;
  std::int64_t utc_s = 0;
};

/// The order that the battery followed when it was read, for a later run to judge the reading again
/// by.
struct FollowedOrder {
  bool is_judged = false;  ///< it was followed since the reading before, unchanged by a limit
  std::int32_t power_w = 0;
  std::int32_t age_s = 0;
  std::int16_t soc_floor_e4 = 0;
};

/// What supervision finds in the battery's answers short of a reason to stop; 0: nothing.
struct ResponseFindings {
  std::int16_t energy_share_percent = 0;  ///< of the measured energy shows in the SoC
  std::int32_t rest_loss_w = 0;           ///< lost at 0 W, or besides orders; negative: gained
  std::int32_t ramp_w_per_s = 0;          ///< from an order on: too slow for its map
  std::int16_t locked_readings = 0;       ///< in a row: by its own limits it may do nothing
  std::int32_t wrong_energy_e6 = 0;       ///< against or beyond orders, of the capacity
};

struct GuardDecision {
  std::int32_t power_w = 0;
  Reason reason = Reason::kLink;
};

/// Everything about one cycle, for the log. Wall microseconds where the name ends in _us.
struct CycleRecord {
  std::int64_t utc_s = 0;
  std::int64_t cycle = 0;
  Mode mode = Mode::kStart;
  bool has_measurement = false;
  BatteryMeasurement measurement{};
  PriceReport price{};
  /// Since the end of the row's minute: at the decision, or when an order was written later, then.
  std::int32_t price_age_s = -1;  ///< -1 = no price
  bool has_student_action = false;
  Action student_action = Action::kIdle;
  std::int32_t ordered_power_w = 0;
  Reason reason = Reason::kLink;
  Status battery_status = Status::kNotConnected;  ///< of the worst battery call of this cycle
  bool written = false;                           ///< an order or a release was sent and read back
  std::int32_t decision_us = 0;
  std::int32_t write_us = 0;         ///< order written and read back
  std::int32_t total_us = 0;         ///< from the price row's arrival to the order read back
  std::int32_t missed_ticks = 0;     ///< ticks skipped since start because a cycle overran
  std::int32_t deadline_misses = 0;  ///< cycles since start whose order was not in force in time
  /// Orders in a row that the battery did not answer with power.
  std::int32_t unanswered_orders = 0;
  DayThroughput throughput{};
  BatteryCounters counters{};
  PriceLevel price_level{};        ///< the prices of this cycle included
  std::int16_t context_class = 0;  ///< what the student was given, 1..12; 0 = it was not asked
  bool is_tripped = false;
  Trip trip{};                       ///< where is_tripped
  std::int32_t weak_answers = 0;     ///< readings in a row with less power than ordered
  std::int32_t replaced_orders = 0;  ///< since start: of ours, by somebody else
  ReversalHistory reversals{};       ///< this cycle's order included
  HoldReport hold{};
  std::int16_t reserve_soc_e4 = 0;   ///< that held at the tick; 0 = none
  std::int16_t days_since_full = 0;  ///< local days since the SoC was last full
  SiteReport site{};
  std::int32_t ended_orders = 0;  ///< since start: gone before their end, by no hand that shows
  LostOrderHistory lost_orders{};
  StandingPrice standing_price{};
  bool price_frozen = false;  ///< it has stood for longer than is told
  ResponseFindings findings{};
  FollowedOrder followed{};
  OutlookReport outlook{};
  bool price_stands_in = false;  ///< the newest is too old: decided on what it has become
  std::int32_t stand_in_centi_eur_per_mwh = 0;
};

/// Of a record with a price: what student, rules and thresholds were asked at.
constexpr std::int32_t decided_price_centi(const CycleRecord& record) {
  return record.price_stands_in ? record.stand_in_centi_eur_per_mwh
                                : record.price.price_centi_eur_per_mwh;
}

}  // namespace bess
