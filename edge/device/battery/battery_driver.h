// Battery driver: measure, order, refresh the watchdog and release through a register map.
// Minimises writes: an order already in force is not written again until the watchdog is due. A
// template over link and time (battery_bus.h).
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "edge/core/control/control_types.h"
#include "edge/device/battery/battery_bus.h"
#include "edge/device/battery/command_runner.h"
#include "edge/device/battery/measurement_reader.h"
#include "edge/device/battery/order_state.h"
#include "edge/device/registers/codec.h"
#include "shared/units_and_limits.h"

namespace bess {

// Identity check: the device matches the register map. Locates its SunSpec models and reads the
// map's identity points. Nothing is measured or written until all of them match. Then it determines
// the optional points of the device.

struct IdentityFailure {
  int check = 0;                    ///< index into RegisterMap::identity, if no model is missing
  std::uint16_t missing_model = 0;  ///< SunSpec model; 0: all required models found
  bool is_known = false;            ///< `value` could be decoded
  std::int64_t value = 0;
  std::uint16_t raw[kTextRegistersMax] = {};

  /// True for a device that is still starting: all zeros or all ones, or no models yet.
  [[nodiscard]] bool is_blank(const RegisterMap& map) const {
    if (missing_model != 0) return true;
    const int count = map.points[map.identity[check].point].registers;
    const auto all = [&](int word) { return std::count(raw, raw + count, word) == count; };
    return all(0) || all(0xFFFF);
  }
};

template <typename Link, typename Time>
Status check_identity_point(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                            const IdentityCheck& check, IdentityFailure& failure) {
  const RegisterPoint& point = map.points[check.point];
  const std::uint16_t* const raw = failure.raw;
  Status status = retried(bus.time(), 0, [&] { return bus.read_point(check.point, failure.raw); });
  if (status != Status::kOk) return status;
  if (point.type == RegisterType::kText) {
    const bool same = decode_text(point, raw).view().starts_with(check.text.view());
    return same ? Status::kOk : Status::kImplausible;
  }
  if (check.may_be_unknown && is_not_implemented(point, raw)) return Status::kOk;
  if (point.scale_from >= 0 || point.percent_of >= 0) {
    status = retried(bus.time(), 0, [&] { return bus.read_due(); });
    if (bus.live().failed[point.scale_from < 0 ? point.percent_of : point.scale_from])
      return status;
  }
  PointValues now = bus.live();
  now.keep(map, check.point, raw);
  failure.is_known = live_value(map, now, check.point, failure.value);
  const bool is_right =
      failure.is_known && failure.value >= check.value_min && failure.value <= check.value_max;
  return is_right ? Status::kOk : Status::kImplausible;
}

/// kImplausible: another device, or one that is not ready; `failure` has the value read.
template <typename Link, typename Time>
Status check_identity_of(const RegisterMap& map, BatteryBus<Link, Time>& bus,
                         IdentityFailure& failure) {
  failure = IdentityFailure{};
  const Status located =
      retried(bus.time(), 0, [&] { return bus.locate_models(failure.missing_model); });
  if (located != Status::kOk) return located;
  for (int i = 0; i < map.identity.size(); ++i) {
    failure = IdentityFailure{.check = i};
    const Status status = check_identity_point(map, bus, map.identity[i], failure);
    if (status != Status::kOk) return status;
  }
  return bus.find_optional_points();
}

template <typename Link, typename Time>
class BatteryDriver {
 public:
  /// `map` must outlive this object; `unit` replaces its unit id if not negative.
  template <typename... LinkArguments>
  BatteryDriver(const RegisterMap& map, const Time& time, std::int32_t unit,
                LinkArguments&&... link)
      : map_(map),
        bus_(map, time, unit, std::forward<LinkArguments>(link)...),
        runner_(map, bus_),
        reader_(map),
        ours_(map.watchdog) {
    for_each_written(
        map, [this](const WriteValue& value) { adds_live_ = adds_live_ || value.plus >= 0; });
  }
  BatteryDriver(const BatteryDriver&) = delete;
  BatteryDriver& operator=(const BatteryDriver&) = delete;

  /// Connects if needed and reads all measured points. If an identity check finds another capacity,
  /// the measurement has only that.
  Status read(BatteryMeasurement& measurement) {
    measurement = BatteryMeasurement{};
    IdentityFailure failure;
    if (const Status status = identify(failure); status != Status::kOk) {
      if (status == Status::kImplausible) note_capacity(failure, measurement);
      return status;
    }
    const Status came = read_registers();
    // After a restart, an order of the previous run must not be overlooked.
    const bool knows_order = ours_.was_ours() || has_read_order_state();
    const bool is_complete =
        came == Status::kOk || (knows_order && !reader_.lacks_required_values(bus_.live()));
    const Status status =
        is_complete ? reader_.translate(bus_.live(), bus_.time().now_ns(), measurement) : came;
    if (status != Status::kOk) {
      measurement = {.lost_point = reader_.lost_required_point(bus_.live())};
      return status;
    }
    note_order_in_force(measurement);
    watch_order(measurement.dispatch_active);
    measurement.order_replaced = ours_.loss() == OrderLoss::kReplaced;
    measurement.order_ended = ours_.loss() == OrderLoss::kEnded;
    return Status::kOk;
  }

  /// Brings an order into force and reads it back. No write if it is in force already.
  Status order(const PowerOrder& order) {
    if (const Status status = prepare(); status != Status::kOk) return refuse(status);
    const Command command = command_of(order.power_w);
    const bool is_same = ours_.is_in_force() && command == ours_.command();
    if (is_same && runner_.is_written(map_.sequence(command), order)) {
      ours_.on_prolonged(order);
      if (ours_.is_due(now_ns())) return feed();
      ++unchanged_orders_;
      return Status::kOk;
    }
    if (order.power_w > map_.charge_w_max || order.power_w < -map_.discharge_w_max) {
      return refuse(Status::kNotExpressible);
    }
    // Nothing is written until all of it is known to be permitted.
    Status status = check(map_.sequence(command), order);
    if (status == Status::kOk && !ours_.is_enabled()) status = enable(order);
    if (status != Status::kOk) return refuse(status);
    // A failing 0 W is retried for less time: the release follows.
    const bool drives = command != Command::kIdle;
    status =
        runner_.run(map_.sequence(command), order, drives ? kOrderPatienceNs : kReadPatienceNs);
    if (status == Status::kOk) {
      ours_.on_taken(command, order, now_ns());
    } else {
      roll_back(status, command, order);
    }
    return status;
  }

  /// Between orders, at least every `refresh_interval_s`: refreshes the watchdog when due.
  Status refresh() { return ours_.is_due(now_ns()) ? feed() : Status::kOk; }

  /// 0: one order per cycle is sufficient for the watchdog.
  [[nodiscard]] std::int32_t refresh_interval_s() const {
    const bool often = !ours_.never_expires() && map_.watchdog.refresh_s < kSecondsPerStep;
    return often ? map_.watchdog.refresh_s : 0;
  }

  /// Returns the battery to its own mode and reads back. It has a budget reserve, and does not
  /// depend on fresh measurements: known scale factors suffice. Unlike an order, it is also
  /// permitted if a known device has since failed its identity check.
  Status release() {
    const Status known = identify();
    if (known != Status::kOk && !(known == Status::kImplausible && was_known())) return known;
    static_cast<void>(prepare());
    const Status status =
        runner_.run(map_.sequence(Command::kRelease), PowerOrder{}, kReadPatienceNs);
    lose_order();
    if (status != Status::kOk) return status;
    runner_.saved().forget();
    ours_.on_released();
    return Status::kOk;
  }

  /// Reads the map's identity checks; on kImplausible `failure` has the check and its value.
  /// Nothing is read or ordered before the first success: an unknown device is not touched.
  Status check_identity(IdentityFailure& failure) {
    const Status status = check_identity_of(map_, bus_, failure);
    if (status == Status::kOk) {
      identity_ = Identity::kKnown;
    } else if (identity_ == Identity::kKnown) {
      identity_ = Identity::kWasKnown;
    }
    identified_ns_ = now_ns();
    identified_connections_ = bus_.link().counters().reconnects;
    return status;
  }

  /// True if the map calls the point optional and this device has it.
  [[nodiscard]] bool has_optional(std::int8_t point) const {
    return map_.points[point].optional && !bus_.live().absent[point];
  }
  /// Optional point that this device is known to have: now required.
  void require(std::int8_t point) { bus_.require(point); }

  /// On an operator's request: release is permitted whatever the identity checks say.
  void permit_release() {
    if (identity_ == Identity::kUnknown) identity_ = Identity::kWasKnown;
  }

  [[nodiscard]] BatteryCounters counters() const {
    BatteryCounters counters = bus_.link().counters();
    counters.unchanged_orders = unchanged_orders_;
    counters.flash_day = bus_.time().utc_day();
    counters.flash_writes_today = runner_.budget().writes_on(counters.flash_day);
    return counters;
  }

  /// At start, from the log: the daily flash budget survives a restart.
  void restore_flash_writes(std::int64_t day, std::int32_t writes) {
    runner_.budget().restore(day, writes);
  }

  /// Encodes a write without accessing the device. kNotConnected while its scale or location needs
  /// a reading of the device.
  Status preview(const BlockWrite& write, const PowerOrder& order, std::uint16_t& address,
                 RegisterBlock& block) const {
    const bool was_read = bus_.last_read_ns() != 0;
    for (const WriteValue& value : write.values) {
      const RegisterPoint& p = map_.points[value.point];
      const bool needs_device =
          p.model >= 0 || p.scale_from >= 0 || p.percent_of >= 0 || value.plus >= 0;
      if (needs_device && !was_read) return Status::kNotConnected;
    }
    address = bus_.placed(write.values[0].point, 3).place.address;
    return encode_block(map_, write, order, block, {.live = was_read ? &bus_.live() : nullptr});
  }

  /// Closes the only connection; the next request opens it again.
  void close() { bus_.link().close(); }
  [[nodiscard]] Link& link() { return bus_.link(); }
  [[nodiscard]] const PointValues& live() const { return bus_.live(); }
  /// Location of a point on this device.
  [[nodiscard]] PlacedPoint place_of(std::int8_t point) const {
    return bus_.placed(point, map_.points[point].read_function);
  }

 private:
  /// Identity of the device: orders need a known one, a release one that was known.
  enum class Identity : std::uint8_t { kUnknown, kWasKnown, kKnown };

  [[nodiscard]] bool was_known() const { return identity_ != Identity::kUnknown; }
  [[nodiscard]] std::int64_t now_ns() const { return bus_.time().now_ns(); }

  static constexpr std::int64_t kLiveAgeNs = 180 * kNanosecondsPerSecond;
  static constexpr std::int64_t kIdentityAgeNs = 600 * kNanosecondsPerSecond;

  Status identify() {
    IdentityFailure failure;
    return identify(failure);
  }

  /// A new connection may lead to another device, and a device may be reconfigured.
  Status identify(IdentityFailure& failure) {
    const bool same_connection = bus_.link().counters().reconnects == identified_connections_;
    const bool is_recent = now_ns() - identified_ns_ < kIdentityAgeNs;
    if (identity_ == Identity::kKnown && same_connection && is_recent) return Status::kOk;
    const std::int64_t patience_ns = was_known() ? kReadPatienceNs : 0;
    return retried(bus_.time(), patience_ns, [&] { return check_identity(failure); });
  }

  void note_capacity(const IdentityFailure& failure, BatteryMeasurement& measurement) const {
    const bool is_value = failure.missing_model == 0 && failure.is_known;
    if (!is_value || map_.points[map_.identity[failure.check].point].name != "capacity") return;
    measurement.capacity_wh = clamp_to_int32(failure.value);
  }

  /// Retries missing values, and refreshes the watchdog while retrying.
  Status read_registers() {
    int attempt = 0;
    return retried(bus_.time(), kReadPatienceNs, [&] {
      if (++attempt > kBusAttempts) static_cast<void>(refresh());
      return attempt == 1 ? bus_.read_due() : bus_.read_rest();
    });
  }

  /// kOk if writing is permitted; flash is compared with the device first.
  Status check(const CommandSequence& sequence, const PowerOrder& order) {
    return retried(bus_.time(), kReadPatienceNs, [&] { return runner_.check(sequence, order); });
  }

  /// Scale factors, ratings and limits of an order must be recent. A map without them can order (0
  /// W above all) even while measurements fail.
  Status prepare() {
    if (const Status status = identify(); status != Status::kOk) return status;
    const bool needs_live = !map_.scales.empty() || (!ours_.is_enabled() && !map_.saved.empty());
    const std::int64_t read_ns = bus_.last_read_ns();
    const bool fresh = read_ns != 0 && now_ns() - read_ns < kLiveAgeNs;
    if (fresh || !needs_live) return Status::kOk;
    const Status status = read_registers();
    return bus_.last_read_ns() == read_ns ? status : Status::kOk;
  }

  /// The newest reading had the registers that show whether an order is in force.
  [[nodiscard]] bool has_read_order_state() const {
    return std::none_of(map_.active.begin(), map_.active.end(),
                        [&](const Condition& c) { return bus_.live().failed[c.point]; });
  }

  /// Order that the device follows, including one from an earlier run. Old registers would describe
  /// the previous order.
  void note_order_in_force(BatteryMeasurement& m) {
    const bool visible = shows_end() && has_read_order_state();  // else by time
    const PointValues now = bus_.live().received();
    const bool active = live_all(map_, map_.active, now);
    // An order of a killed process: its expiry is not visible, but the external control that it
    // enabled remains until the release.
    const bool left_behind = !visible && !ours_.was_ours() && active;
    m.dispatch_active = visible ? active : ours_.may_last(now_ns()) || left_behind;
    std::int64_t power_w = 0;
    m.has_order_power =
        m.dispatch_active && !left_behind && live_power(map_, map_.order_power, now, power_w);
    if (m.has_order_power) m.order_power_w = clamp_to_int32(power_w);
    std::int64_t left_s = 0;
    const int remaining = map_.watchdog.remaining;
    const bool is_shown = remaining >= 0 && live_value(map_, now, remaining, left_s);
    ours_.note_seconds_left(is_shown ? left_s : INT64_MAX);
  }

  /// Looks for the order in force where it was written. `active`: the device reports that it
  /// follows an order, if it can.
  void watch_order(bool active) {
    if (!ours_.is_in_force()) return;
    if (!active && !ours_.is_within_its_time(now_ns())) return lose_order();  // expired
    OrderTrace trace = OrderTrace::kOurs;  // also if it cannot be read now
    static_cast<void>(runner_.trace(ours_.command(), trace));
    if (trace == OrderTrace::kForeign || (active && trace == OrderTrace::kAtRest)) {
      note_loss(OrderLoss::kReplaced, trace);
    } else if (!active && (trace == OrderTrace::kAtRest ||
                           ours_.has_settled(now_ns(), map_.response.settle_s))) {
      note_loss(OrderLoss::kEnded, trace);
    }
  }

  /// Before a refresh: false, and recorded, if the order is no longer there.
  [[nodiscard]] bool is_still_there() {
    OrderTrace trace = OrderTrace::kOurs;
    const Status status = runner_.trace(ours_.command(), trace);
    if (status != Status::kOk || trace == OrderTrace::kOurs) return true;
    // Only a fresh reading shows that the device still follows an order.
    const bool may_be_end = trace == OrderTrace::kAtRest && shows_end();
    const bool is_active =
        may_be_end && bus_.read_due() == Status::kOk && live_all(map_, map_.active, bus_.live());
    note_loss(may_be_end && !is_active ? OrderLoss::kEnded : OrderLoss::kReplaced, trace);
    return false;
  }

  /// The next order writes everything again, unless control yields. Not earlier: two competing
  /// controllers would make the power oscillate.
  void note_loss(OrderLoss loss, OrderTrace trace) {
    ours_.on_lost(loss, trace == OrderTrace::kForeign, now_ns());
    runner_.forget();
  }

  /// True if registers show whether the device follows an order.
  [[nodiscard]] bool shows_end() const {
    return !map_.active.empty() && map_.watchdog.expiry_visible;
  }

  Status feed() {
    if (!is_still_there()) return Status::kNotApplied;
    const CommandSequence& refresh = map_.sequence(Command::kRefresh);
    const CommandSequence& sequence =
        refresh.writes.empty() ? map_.sequence(ours_.command()) : refresh;
    PowerOrder order = ours_.order();
    order.write_until_ns = order.feed_until_ns;
    // Live values added to an order change between two ticks.
    Status status = adds_live_ ? bus_.read_points(map_.scales) : Status::kOk;
    if (status == Status::kOk) status = check(sequence, order);
    if (status == Status::kOk) status = runner_.run(sequence, order, kReadPatienceNs);
    if (status == Status::kOk) {
      ours_.on_fed(now_ns());
    } else {
      lose_order();  // the next order writes everything again
    }
    return status;
  }

  /// Before the first order: preconditions, registers to restore later, external control.
  Status enable(const PowerOrder& order) {
    for (const Condition& condition : map_.precondition) {
      bool holds = false;
      const Status status =
          retried(bus_.time(), kReadPatienceNs, [&] { return runner_.test(condition, holds); });
      if (status != Status::kOk) return status;
      if (!holds) return Status::kNotPermitted;
    }
    Status status = retried(bus_.time(), kReadPatienceNs, [this] { return save_registers(); });
    const CommandSequence& sequence = map_.sequence(Command::kEnable);
    if (status == Status::kOk) status = check(sequence, order);
    if (status != Status::kOk) return status;
    status = runner_.run(sequence, order, kReadPatienceNs);
    if (status == Status::kOk) {
      ours_.on_enabled();
    } else {
      roll_back(status, Command::kEnable, order);
    }
    return status;
  }

  /// An active order that is not ours is an earlier process's: the registers hold its values, so
  /// that the map's fallback will be restored.
  Status save_registers() {
    StaticVector<std::int8_t, kPointsMax> unsaved;
    for (const SavedPoint& saved : map_.saved) {
      if (!runner_.saved().known[saved.point]) unsaved.push_back(saved.point);
    }
    if (unsaved.empty() || live_all(map_, map_.active, bus_.live())) return Status::kOk;
    const Status status = runner_.read_written(unsaved, runner_.saved());
    for (const std::int8_t point : unsaved) {
      Scaling scaling;
      std::int64_t value = 0;  // "not implemented" must not be written back
      const bool good = live_scaling(map_, bus_.live(), point, scaling) &&
                        decode(map_.points[point], runner_.saved().raw[point], value, scaling);
      if (!good) runner_.saved().known[point] = false;
    }
    return status;
  }

  /// The order before a refused one is no longer valid either: `refresh` must not keep it in force.
  /// Its timer ends it; without a timer it is released here.
  Status refuse(Status reason) {
    const bool stays = ours_.is_in_force() && ours_.never_expires();
    lose_order();
    if (stays) static_cast<void>(runner_.run(map_.sequence(Command::kRelease), PowerOrder{}, 0));
    return reason;
  }

  /// A command may be half applied: the battery's own mode is better than a mixture.
  void roll_back(Status reason, Command command, const PowerOrder& order) {
    const bool sent = reason != Status::kNotExpressible && reason != Status::kImplausible;
    const bool several = map_.sequence(command).writes.size() > 1 || ours_.is_enabled();
    lose_order();
    if (!sent || !(several || reason == Status::kNotApplied)) return;
    PowerOrder unbound = order;  // a rollback is never too late
    unbound.write_until_ns = INT64_MAX;
    static_cast<void>(runner_.run(map_.sequence(Command::kRelease), unbound,
                                  0));  // the link may be gone: the watchdog ends it
  }

  void lose_order() {
    ours_.on_lost();
    runner_.forget();
  }

  const RegisterMap& map_;
  BatteryBus<Link, Time> bus_;
  CommandRunner<Link, Time> runner_;
  MeasurementReader reader_;
  OrderState ours_;
  bool adds_live_ = false;  ///< a measured load is added to orders
  Identity identity_ = Identity::kUnknown;
  std::int64_t identified_ns_ = 0;
  std::int64_t identified_connections_ = 0;
  std::int64_t unchanged_orders_ = 0;
};

}  // namespace bess
