// Simulated battery of any map behind the driver, without sockets: the register image of bess-sim
// in memory, in time set by the test.
#pragma once

#include <string>

#include "tests/support/register_device.h"
#include "tools/simulators/battery_sim/register_image.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

struct SimulatedDevice {
  static constexpr std::int64_t kStartUtcS = 1'679'788'800;
  static constexpr BatteryParameters kHouse{.power_w_max = 4'000, .capacity_wh = 8'000};

  MapUnderTest test;
  SimulatedBattery battery;
  RegisterImage image;

  explicit SimulatedDevice(const std::string& map, const std::string& variant = "")
      : test(shipped_map(map), variant),
        battery(kHouse, 0.5, kStartUtcS * kNanosecondsPerSecond),
        image(test.map, battery, test.device.holding, test.device.input) {
    test.device.before_request = [this] { image.refresh(utc_ns()); };
    test.device.after_write = [this](int address, int count) { image.apply_write(address, count); };
  }

  [[nodiscard]] std::int64_t utc_ns() const {
    return kStartUtcS * kNanosecondsPerSecond + test.device.now_ns;
  }
  /// Grid-side energy since the start.
  [[nodiscard]] double energy_wh() {
    battery.advance(utc_ns());
    double sum_wh = 0;
    for (const MinuteRecord& minute : battery.record()) sum_wh += minute.energy_wh;
    return sum_wh;
  }
};

}  // namespace bess
