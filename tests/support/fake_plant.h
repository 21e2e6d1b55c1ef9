// Fake plant: the control loop with a clock that jumps from deadline to deadline, the simulator's
// physics behind the battery interface, and a price source, without I/O. Public fields switch
// faults.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "edge/core/loop/control_loop.h"
#include "edge/device/registers/codec.h"
#include "shared/scaled_clock.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

inline constexpr std::int64_t kDayStartS =
    1'679'781'600;  // 2023-03-25T22:00:00Z, into the spring change
inline constexpr BatteryParameters kHouse{.power_w_max = 4'000, .capacity_wh = 8'000};

struct FakeClock {
  std::int64_t now_ns = kDayStartS * kNanosecondsPerSecond;
  bool stop = false;
  bool synchronised = true;
  std::int64_t step_back_ns = 0;  ///< subtracted during the next sleep, which it ends

  [[nodiscard]] std::int64_t now_utc_ns() const { return now_ns; }
  [[nodiscard]] std::int64_t monotonic_ns() const { return now_ns; }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const { return utc_ns; }
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    now_ns = std::max(now_ns, utc_ns) - std::exchange(step_back_ns, 0);
    return !stop;
  }
  void pause_ns(std::int64_t ns) { now_ns += ns; }
  [[nodiscard]] bool stop_requested() const { return stop; }
  [[nodiscard]] bool is_synchronised() const { return synchronised; }
};

/// The physics of the simulator behind the loop's battery interface, with switchable faults.
struct FakeBattery {
  explicit FakeBattery(FakeClock& c, double soc) : clock(c), physics(kHouse, soc, c.now_ns) {}

  Status read(BatteryMeasurement& m) {
    physics.advance(clock.now_ns);
    if (!link) return Status::kTimeout;
    if (is_implausible) return Status::kImplausible;
    m = BatteryMeasurement{};
    m.soc_e4 = static_cast<std::int32_t>(std::lround(physics.soc_frac() * 1e3)) * 10;
    m.power_w = static_cast<std::int32_t>(physics.power_w());
    m.capacity_wh = 8'000;
    m.alarm = alarm;
    m.off_grid = off_grid;
    m.dispatch_active = physics.dispatch_active();
    m.has_order_power = true;
    m.order_power_w = static_cast<std::int32_t>(physics.commanded_power_w());
    if (inverted) m.power_w = -m.power_w;
    m.power_w += offset_w;
    if (changed) changed(m);
    clock.now_ns += read_takes_ns;
    return Status::kOk;
  }
  Status order(const PowerOrder& o) {
    physics.advance(clock.now_ns);
    orders.push_back(o);
    if (!link) return Status::kTimeout;
    if (refuses_orders) return Status::kNotPermitted;
    const std::int32_t limit_e4 = o.power_w < 0 ? o.soc_min_e4 : o.soc_max_e4;
    physics.start_dispatch(o.power_w, limit_e4 / 1e4, o.duration_s);
    return Status::kOk;
  }
  [[nodiscard]] std::int32_t refresh_interval_s() const { return refresh_s; }
  Status refresh() {
    refreshed_ns.push_back(clock.now_ns);
    return link ? Status::kOk : Status::kTimeout;
  }
  [[nodiscard]] BatteryCounters counters() const {
    return {.requests = static_cast<std::int64_t>(orders.size())};
  }
  Status release() {
    physics.advance(clock.now_ns);
    if (!link || failing_releases-- > 0) return Status::kTimeout;
    ++releases;
    physics.stop_dispatch();
    return Status::kOk;
  }

  FakeClock& clock;
  SimulatedBattery physics;
  bool link = true;
  bool is_implausible = false;  ///< its readings; receives the orders
  bool alarm = false;
  bool off_grid = false;
  std::int32_t offset_w = 0;                         ///< offset of its meter
  bool inverted = false;                             ///< its meter has the wrong sign
  std::function<void(BatteryMeasurement&)> changed;  ///< what it shows otherwise
  bool refuses_orders = false;
  int failing_releases = 0;  ///< number of next releases that fail
  std::int64_t read_takes_ns = 0;
  std::int32_t refresh_s = 0;
  std::vector<std::int64_t> refreshed_ns;
  int releases = 0;
  std::vector<PowerOrder> orders;
};

/// Publishes `price(minute)` for every minute except during an outage.
struct FakePrices {
  explicit FakePrices(FakeClock& c) : clock(c) {}

  void request(std::int64_t minute_utc_s, std::int64_t, std::int64_t) { wanted = minute_utc_s; }
  bool wait(std::int64_t until_ns) {
    if (!outage) {
      clock.now_ns += arrives_after_ns;
      wanted += arrives_after_ns / (60 * kNanosecondsPerSecond) * 60;
      report = {.has_row = true,
                .minute_utc_s = wanted,
                .price_centi_eur_per_mwh = price(wanted),
                .received_monotonic_ns = clock.now_ns,
                .status = Status::kOk};
      return true;
    }
    clock.now_ns = std::max(clock.now_ns, until_ns);
    report.status = Status::kTimeout;
    return false;
  }
  [[nodiscard]] PriceReport latest() const { return report; }

  FakeClock& clock;
  std::int64_t wanted = 0;
  bool outage = false;
  std::int64_t arrives_after_ns = 0;  ///< with the newest row at that time
  PriceReport report;
  std::function<std::int32_t(std::int64_t)> price = [](std::int64_t minute_utc_s) {
    const double hours = static_cast<double>(minute_utc_s % 86'400) / 3'600;
    return static_cast<std::int32_t>(std::lround(10'000 + 20'000 * std::sin(hours)));
  };
};

/// Behind a meter, with these limits of the connection.
inline SiteSettings metered(const ConnectionSettings& connection = {}) {
  SiteSettings settings;
  settings.meter = MeterSource::kMap;
  settings.connection = connection;
  return settings;
}

inline constexpr std::int32_t kCheapCenti = -60'000;  ///< below every threshold: charge

template <typename Loop>
CycleRecord run_cycle(Loop& loop) {
  CycleRecord record;
  EXPECT_TRUE(loop.run_cycle(record));
  return record;
}

/// In control, unless the settings differ.
struct FakePlant {
  using Loop = ControlLoop<FakeBattery, FakePrices, FakeClock>;

  explicit FakePlant(double soc = 0.5,
                     const ControlSettings& settings = {.control = true, .guard = {}})
      : battery(clock, soc), prices(clock), loop(settings, battery, prices, clock) {}
  CycleRecord cycle() { return run_cycle(loop); }
  CycleRecord stop() {
    CycleRecord record;
    loop.stop(record);
    return record;
  }
  /// Always the same.
  void set_price(std::int32_t centi) {
    prices.price = [centi](std::int64_t) { return centi; };
  }

  FakeClock clock;
  FakeBattery battery;
  FakePrices prices;
  Loop loop;
};

}  // namespace bess
