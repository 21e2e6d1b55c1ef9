// Parts of a decision other than price and student: site, hold, reserve, full charge, frozen price,
// budget, cap, supervision. The loop calls them in the order of CycleParts. The record that a part
// reports to is the state that the next run restores it from. A new part is one class, derived from
// CyclePart, and one row at the end. No virtual functions, no allocation.
#pragma once

#include <cstdint>
#include <optional>
#include <tuple>

#include "edge/core/control/control_types.h"
#include "edge/core/control/cycle_budget.h"
#include "edge/core/control/frozen_price.h"
#include "edge/core/control/full_charge.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/reserve.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/loop/control_settings.h"
#include "edge/core/site/site_limits.h"
#include "edge/core/supervision/response.h"
#include "edge/core/supervision/supervision.h"
#include "shared/units_and_limits.h"

namespace bess {

// Time of the readings in a log, without clock steps: records have ticks, and a clock step between
// two of them distorts the time between them. The age of the followed order was measured steadily,
// and shows the step.

class RestoredClock {
 public:
  /// Time of the next reading, oldest first, `read_lead_s` before its tick; in UTC, advanced by
  /// `ahead_s`.
  std::int64_t steady_s(const CycleRecord& record, std::int32_t read_lead_s) {
    const std::int64_t utc_s = record.utc_s - read_lead_s;
    if (utc_s_ == 0) utc_s_ = utc_s;
    const std::int64_t by_clock_s = utc_s - utc_s_;
    steady_ahead_s_ += elapsed_s(record.followed, by_clock_s, read_lead_s) - by_clock_s;
    utc_s_ = utc_s;
    followed_ = record.followed;
    return utc_s + steady_ahead_s_;
  }
  /// Steady time minus UTC at the newest reading.
  [[nodiscard]] std::int64_t ahead_s() const { return steady_ahead_s_; }

 private:
  static constexpr std::int64_t kDoubtS =
      kSecondsPerStep / 2;                          ///< an order may wait that long for its price
  static constexpr std::int64_t kTooLongS = 3'600;  ///< readings further apart are not compared

  [[nodiscard]] std::int64_t elapsed_s(const FollowedOrder& now, std::int64_t by_clock_s,
                                       std::int32_t read_lead_s) const {
    if (!now.is_judged || !followed_.is_judged) return by_clock_s;
    const bool goes_on = now.power_w == followed_.power_w && now.age_s > followed_.age_s;
    if (goes_on) return now.age_s - followed_.age_s;
    const std::int64_t by_age_s = std::int64_t{now.age_s} + read_lead_s;
    if (by_age_s > by_clock_s) return by_age_s;  // cannot be older than the previous reading
    // A clock step forward, or a missing reading: the energy in between is unknown.
    return by_age_s < by_clock_s - kDoubtS ? by_clock_s + kTooLongS : by_clock_s;
  }

  std::int64_t utc_s_ = 0;  ///< of the previous reading; 0 = none
  std::int64_t steady_ahead_s_ = 0;
  FollowedOrder followed_{};
};

enum class ReadingPurpose : std::uint8_t {
  kTick,   ///< at a tick, before its decision
  kLast,   ///< at the end of a run, after its release
  kCheck,  ///< between two ticks: is the order still allowed?
  kCut     ///< just before the order is cut
};

/// Result of a battery reading.
struct Reading {
  ReadingPurpose purpose = ReadingPurpose::kTick;
  std::int64_t utc_s = 0;       ///< the tick; between two ticks, now
  Status status = Status::kOk;  ///< of the reading
  bool is_read = false;
  bool is_under_control = false;
  bool holds_nothing = false;  ///< the battery follows no order of ours
  bool drives = false;         ///< an order of ours other than 0 W is in force
  Response response{};

  /// The energy since the previous reading belongs to one order.
  [[nodiscard]] bool ends_step() const {
    return purpose == ReadingPurpose::kTick || purpose == ReadingPurpose::kLast;
  }
};

/// Time at which the guard decides.
struct Moment {
  bool is_tick = true;  ///< false: the present limits are applied to the order in force
  Margin margin = Margin::kWhole;
};

struct CyclePart {
  /// Restores the newest record of an earlier run.
  void restore(const CycleRecord&) {}
  /// A cycle of an earlier run, oldest first and before `restore`.
  void recall(const CycleRecord&, bool /*is_under_control*/) {}
  void observe(const Reading&) {}
  /// Adds to the guard's inputs; what applies to this cycle only is recorded too. A limit with a
  /// new reason needs no change of the guard: `in.site.limit_charge(power_w, reason)`,
  /// `limit_discharge` or `forbid`.
  void put(const Moment&, CycleRecord&, GuardInputs&) {}
  /// The power ordered now.
  void note(std::int32_t) {}
  void report(CycleRecord&) const {}
};

// House, connection and outside limits; first, because limits of other parts are within them.

template <typename Site>
struct SitePart : CyclePart {
  explicit SitePart(const Site& of) : site(of) {}

  void restore(const CycleRecord& before) { site.take_over(before.utc_s, before.site); }
  void observe(const Reading& now) {
    if (now.purpose != ReadingPurpose::kTick && now.purpose != ReadingPurpose::kCheck) return;
    const Response& response = now.response;
    site.observe(response.utc_s, now.is_read, response.measurement,
                 {.is_driven = now.is_read && response.is_driven, .age_s = response.order_age_s});
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    in.site = site.range(in.now_utc_s, now.margin);
  }
  void report(CycleRecord& record) const { record.site = site.report(record.utc_s); }

  Site site;
};

// An operator's requests: a hold, and a reserve at this hour.

struct HoldPart : CyclePart {
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick && latest_hold != nullptr)
      record.hold = hold_at(latest_hold->latest(), record.utc_s);
    in.held = record.hold.held;
    in.held_power_w = record.hold.power_w;
  }

  const LatestHold* latest_hold = nullptr;
};

struct ReservePart : CyclePart {
  explicit ReservePart(const ReservePlan& of_day) : plan(of_day) {}

  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick) {
      soc_e4 = reserve_soc_e4_at(plan, local_minute_of(record.utc_s));
      record.reserve_soc_e4 = soc_e4;
    }
    in.reserve_soc_e4 = soc_e4;
  }

  ReservePlan plan;
  std::int16_t soc_e4 = 0;  ///< reserve of this hour; 0 = none
};

// Bounds on wear: full cycles per day, and reversals per hour.

struct CycleBudgetPart : CyclePart {
  explicit CycleBudgetPart(std::int32_t per_day_max_e4) : budget(per_day_max_e4) {}

  void restore(const CycleRecord& before) { budget.restore(before.throughput); }
  void observe(const Reading& now) {
    if (now.purpose == ReadingPurpose::kCheck) return;
    if (!now.is_read) return budget.forget_soc();
    const std::int32_t today = local_day_of(local_minute_of(now.utc_s));
    budget.update(today, now.response.measurement.soc_e4, now.drives);
  }
  void put(const Moment&, CycleRecord&, GuardInputs& in) {
    in.cycle_budget_spent = budget.is_spent();
  }
  void report(CycleRecord& record) const { record.throughput = budget.today(); }

  CycleBudget budget;
};

struct ReversalCapPart : CyclePart {
  explicit ReversalCapPart(std::int32_t per_hour_max) : cap(per_hour_max) {}

  void restore(const CycleRecord& before) { cap.restore(before.reversals, before.utc_s); }
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick) cap.advance(record.utc_s);
    in.barred_direction = cap.barred_direction();
  }
  void note(std::int32_t power_w) { cap.note(power_w); }
  void report(CycleRecord& record) const { record.reversals = cap.history(); }

  ReversalCap cap;
};

// Other prices: the level with which student and full charge compare a price, the outlook, and a
// frozen price.

struct FullChargePart : CyclePart {
  explicit FullChargePart(std::int32_t every_days) : charge(every_days) {}

  void restore(const CycleRecord& before) {
    level = before.price_level;
    charge.restore(last_full_day_of(before.utc_s, before.days_since_full));
  }
  void observe(const Reading& now) {
    if (!now.is_read || !now.ends_step()) return;
    charge.update(local_day_number(local_minute_of(now.utc_s)), now.response.measurement.soc_e4);
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    if (now.is_tick && in.has_price) {
      level.observe(in.price_minute_utc_s, in.price_centi_eur_per_mwh);
    }
    in.full_charge = charge.request(in.price_centi_eur_per_mwh, level);
  }
  void report(CycleRecord& record) const {
    record.price_level = level;
    record.days_since_full = charge.days_since_full();
  }

  PriceLevel level;
  FullCharge charge;
};

struct OutlookPart : CyclePart {
  void restore(const CycleRecord& before) { planned_utc_s = before.outlook.planned_utc_s; }
  /// Source of the student's context class; the battery was read.
  std::int32_t context_centi(const PriceLevel& level, CycleRecord& record) {
    const std::int32_t level_centi = level.centi_eur_per_mwh();
    if (exchange == nullptr) return level_centi;
    record.outlook = outlook_at(*exchange, record.utc_s, record.measurement.soc_e4, level_centi);
    if (record.outlook.source == OutlookSource::kPlanned || planned_utc_s == 0) {
      planned_utc_s = record.utc_s;
    }
    return record.outlook.break_even_centi;
  }
  void report(CycleRecord& record) const { record.outlook.planned_utc_s = planned_utc_s; }

  OutlookExchange* exchange = nullptr;  ///< null unless the outlook is the student's context
  std::int64_t planned_utc_s = 0;
};

struct FrozenPricePart : CyclePart {
  explicit FrozenPricePart(const FrozenPriceSettings& settings) : frozen(settings) {}

  void restore(const CycleRecord& before) { frozen.restore(before.standing_price); }
  void recall(const CycleRecord& then, bool) {
    if (!then.price.has_row) return;
    frozen.recall(then.price.minute_utc_s, then.price.price_centi_eur_per_mwh);
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    if (now.is_tick && in.has_price) {
      frozen.observe(in.price_minute_utc_s, in.price_centi_eur_per_mwh);
    }
    in.price_is_frozen = frozen.is_no_price();
  }
  void report(CycleRecord& record) const {
    record.standing_price = frozen.price();
    record.price_frozen = frozen.is_frozen();
  }

  FrozenPrice frozen;
};

// Supervision of the battery's response. Findings of an earlier run, except trips, are reproduced
// from its logged readings: restarting the program hides nothing.

struct SupervisionPart : CyclePart {
  SupervisionPart(const SupervisionSettings& settings, std::int32_t lead_s)
      : supervision(settings), read_lead_s(lead_s) {}

  void take_over(const CycleRecord& before, const std::optional<Trip>& trip) {
    supervision.restore(trip);
    const bool was_cleared = before.is_tripped && !trip;
    supervision.restore(was_cleared ? ResponseFindings{} : before.findings);
    supervision.restore(before.lost_orders, before.utc_s + time.ahead_s());
  }
  void recall(const CycleRecord& then, bool is_under_control) {
    if (!is_under_control || !then.has_measurement) return;
    supervision.recall({.utc_s = then.utc_s - read_lead_s,
                        .steady_s = time.steady_s(then, read_lead_s),
                        .is_driven = then.followed.is_judged,
                        .ordered_power_w = then.followed.power_w,
                        .order_age_s = then.followed.age_s,
                        .soc_floor_e4 = then.followed.soc_floor_e4,
                        .measurement = then.measurement});
    if (then.mode == Mode::kRunning) supervision.on_ordered(then.utc_s, then.battery_status);
  }
  void observe(const Reading& now) {
    const std::int32_t capacity_wh = now.response.measurement.capacity_wh;
    if (!now.is_under_control) return;
    if (now.purpose == ReadingPurpose::kCut) return supervision.note_power(now.response);
    if (now.purpose == ReadingPurpose::kCheck && now.is_read)
      return supervision.note_between(now.response);
    if (!now.ends_step()) return;
    const bool is_lost = now.response.measurement.lost_point != 0;
    if (is_lost && now.is_read) {
      supervision.note_unread(now.utc_s, now.drives, true);
    } else if (now.is_read) {
      supervision.observe(now.response, now.holds_nothing);
    } else if (capacity_wh > 0) {
      supervision.note_capacity(capacity_wh);
    } else {
      supervision.note_unread(now.utc_s, now.drives, is_temporary(now.status));
    }
  }
  void put(const Moment&, CycleRecord&, GuardInputs& in) {
    in.supervision = supervision.stop_reason();
  }
  void report(CycleRecord& record) const {
    const ResponseMonitor& response = supervision.response();
    record.unanswered_orders = response.unanswered_orders();
    record.weak_answers = response.weak_answers();
    record.findings = response.findings();
    record.replaced_orders = supervision.lost_orders().replaced();
    record.ended_orders = supervision.lost_orders().ended();
    record.lost_orders = supervision.lost_orders().history();
    record.is_tripped = supervision.trip().has_value();
    record.trip = supervision.trip().value_or(Trip{});
  }

  Supervision supervision;
  RestoredClock time;
  std::int32_t read_lead_s;
};

template <typename Site>
auto parts_of(const ControlSettings& settings, const Site& site) {
  return std::tuple(SitePart<Site>(site),                              //
                    HoldPart(),                                        //
                    ReservePart(settings.reserve),                     //
                    FullChargePart(settings.full_charge_every_days),   //
                    OutlookPart(),                                     //
                    FrozenPricePart(settings.frozen_price),            //
                    CycleBudgetPart(settings.cycles_per_day_max_e4),   //
                    ReversalCapPart(settings.reversals_per_hour_max),  //
                    SupervisionPart(settings.supervision, settings.read_lead_s));
}

template <typename Site>
class CycleParts {
 public:
  CycleParts(const ControlSettings& settings, const Site& site)
      : parts_(parts_of(settings, site)) {}

  void restore(const CycleRecord& before) {
    each([&](auto& part) { part.restore(before); });
  }
  void recall(const CycleRecord& then, bool is_under_control) {
    each([&](auto& part) { part.recall(then, is_under_control); });
  }
  void observe(const Reading& now) {
    each([&](auto& part) { part.observe(now); });
  }
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    each([&](auto& part) { part.put(now, record, in); });
  }
  void note(std::int32_t power_w) {
    each([&](auto& part) { part.note(power_w); });
  }
  void report(CycleRecord& record) const {
    std::apply([&](const auto&... part) { (part.report(record), ...); }, parts_);
  }

  template <typename Part>
  [[nodiscard]] Part& get() {
    return std::get<Part>(parts_);
  }
  template <typename Part>
  [[nodiscard]] const Part& get() const {
    return std::get<Part>(parts_);
  }

 private:
  template <typename Say>
  void each(const Say& say) {
    std::apply([&](auto&... part) { (say(part), ...); }, parts_);
  }

  decltype(parts_of(std::declval<const ControlSettings&>(), std::declval<const Site&>())) parts_;
};

}  // namespace bess
