// Supervised site: the real control loop and driver around the simulated battery of any shipped
// map, in moved time. Faults are switched between two control cycles, or while the loop sleeps.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "edge/core/loop/control_loop.h"
#include "tests/support/image_device.h"
#include "tools/simulators/battery_sim/house_load.h"

namespace bess {

/// The device's time as the loop's clock; `every_half_minute` runs while the loop sleeps.
struct MovedClock {
  explicit MovedClock(SimulatedDevice& d) : device(d) {
    d.test.device.sleep = [this](std::int64_t ns) { sleep_until_utc_ns(now_utc_ns() + ns); };
  }
  MovedClock(const MovedClock&) = delete;
  MovedClock& operator=(const MovedClock&) = delete;

  [[nodiscard]] std::int64_t now_utc_ns() const { return device.utc_ns() + step_ns; }
  [[nodiscard]] std::int64_t monotonic_ns() const { return device.test.device.now_ns; }
  [[nodiscard]] std::int64_t monotonic_ns_at(std::int64_t utc_ns) const {
    return monotonic_ns() + utc_ns - now_utc_ns();
  }
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    constexpr std::int64_t kHalfMinuteNs = 30 * kNanosecondsPerSecond;
    while (now_utc_ns() < utc_ns) {
      const std::int64_t next_ns = (now_utc_ns() / kHalfMinuteNs + 1) * kHalfMinuteNs;
      device.test.device.now_ns += std::min(next_ns, utc_ns) - now_utc_ns();
      if (now_utc_ns() == next_ns) every_half_minute();
    }
    return true;
  }
  void pause_ns(std::int64_t ns) const { device.test.device.now_ns += ns; }
  [[nodiscard]] static bool stop_requested() { return false; }
  [[nodiscard]] static bool is_synchronised() { return true; }

  SimulatedDevice& device;
  std::int64_t step_ns = 0;  ///< error of the machine's UTC
  std::function<void()> every_half_minute = [] {};
};

struct PromptPrices {
  void request(std::int64_t minute_utc_s, std::int64_t, std::int64_t) {
    if (!published(minute_utc_s)) {
      report.status = Status::kNoRow;
      return;
    }
    report = {.has_row = true,
              .minute_utc_s = minute_utc_s,
              .price_centi_eur_per_mwh = price(minute_utc_s),
              .status = Status::kOk};
  }
  static bool wait(std::int64_t) { return true; }
  [[nodiscard]] PriceReport latest() const { return report; }

  PriceReport report;
  std::function<bool(std::int64_t)> published = [](std::int64_t) { return true; };
  std::function<std::int32_t(std::int64_t)> price = [](std::int64_t) { return 0; };
};

/// A house behind the same meter.
struct HouseMeter {
  Status read(std::int32_t& grid_power_w) {
    device.battery.advance(device.utc_ns());
    const double house_w = house.power_w(device.utc_ns() / kNanosecondsPerSecond);
    grid_power_w = static_cast<std::int32_t>(std::lround(house_w + device.battery.power_w()));
    return Status::kOk;
  }
  SimulatedDevice& device;
  HouseLoad house = HouseLoad::daily(3);
};

struct NoOutsideLimits {
  static Status read(OutsideLimit&, bool&) { return Status::kOk; }
};

class SupervisedSite {
 public:
  using Site = SiteLimits<HouseMeter, NoOutsideLimits>;
  using Loop = ControlLoop<DeviceDriver, PromptPrices, MovedClock, Site>;

  explicit SupervisedSite(const MapVariant& variant, const ControlSettings& settings = {},
                          const SiteSettings& site = {})
      : device(variant.map, variant.variant), clock(device), settings_(settings), site_(site) {
    settings_.control = true;
    settings_.order_duration_s = device.test.map.watchdog.duration_s;
    settings_.has_watchdog = device.test.map.watchdog.duration_s > 0;
    settings_.supervision.response.band = device.test.map.response;
    settings_.supervision.capacity_wh_min = 6'000;
    settings_.supervision.capacity_wh_max = 10'000;
    start();
  }

  /// A process without memory: only the order that the battery follows remains of the previous one.
  void start() {
    loop.reset();
    device.test.driver = std::make_unique<DeviceDriver>(
        device.test.map, DeviceClock(device.test.device), -1, device.test.device);
    loop = std::make_unique<Loop>(settings_, *device.test.driver, prices, clock,
                                  Site(site_, &meter, nullptr));
  }

  CycleRecord cycle() {
    CycleRecord record;
    EXPECT_TRUE(loop->run_cycle(record));
    return record;
  }

  SimulatedDevice device;
  HouseMeter meter{device};
  MovedClock clock;
  PromptPrices prices;
  std::unique_ptr<Loop> loop;

 private:
  ControlSettings settings_;
  SiteSettings site_;
};

/// Two control cycles of charging, two of discharging, beyond the thresholds.
inline void trade_both_ways(SupervisedSite& site) {
  site.prices.price = [](std::int64_t minute_utc_s) {
    return minute_utc_s / 240 % 2 == 0 ? -60'000 : 160'000;
  };
}

inline void set_habits(SupervisedSite& site, const BatteryHabits& habits) {
  site.device.battery.advance(site.clock.now_utc_ns());
  site.device.battery.set_habits(habits);
}

inline void set_display(SupervisedSite& site, const RegisterImage::Display& display) {
  site.device.image.refresh(site.clock.now_utc_ns());
  site.device.image.set_display(display);
}

}  // namespace bess
