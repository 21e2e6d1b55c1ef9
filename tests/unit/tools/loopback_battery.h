// Simulated battery on its own thread, over TCP on a free port or over a pair of pseudo terminals,
// in scaled time, and the edge's settings for it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <optional>
#include <string>
#include <thread>

#include "edge/device/battery/modbus_link.h"
#include "shared/host/pty_bridge.h"
#include "tests/support/shipped_maps.h"
#include "tools/simulators/battery_sim/battery_server.h"

namespace bess {

enum class Transport { kTcp, kRtu };

class LoopbackBattery {
 public:
  static constexpr std::int32_t kScale = 1'000;  ///< the map's gap of 400 ms takes 0.4 ms
  static constexpr BatteryParameters kHouse{.power_w_max = 4'000, .capacity_wh = 8'000};

  explicit LoopbackBattery(const char* variant, BatteryServerSettings settings = {},
                           Transport transport = Transport::kTcp,
                           const BatteryParameters& parameters = kHouse)
      : LoopbackBattery(load_shipped_map({"alphaess", variant}), settings, transport, parameters,
                        kScale) {}

  LoopbackBattery(const RegisterMap& register_map, BatteryServerSettings settings,
                  Transport transport, const BatteryParameters& parameters, std::int32_t time_scale)
      : map(register_map), battery_(parameters, 0.5, 0) {
    clock.scale = time_scale;
    clock.anchor_utc_s = 1'679'788'800;
    clock.anchor_monotonic_ns = clock_ns(CLOCK_MONOTONIC);
    battery_ = SimulatedBattery(parameters, 0.5, clock.now_utc_ns());
    settings.port = 0;
    if (transport == Transport::kRtu) settings.serial_device = line_.emplace().device(0);
    server_.emplace(settings, map, battery_, clock);
    EXPECT_EQ(pipe(stop_), 0);
    thread_ = std::thread([this] { server_->run(stop_[0]); });
  }
  LoopbackBattery(const LoopbackBattery&) = delete;
  LoopbackBattery& operator=(const LoopbackBattery&) = delete;
  ~LoopbackBattery() {
    stop();
    ::close(stop_[0]);
  }

  [[nodiscard]] BatteryLinkSettings link(std::int32_t response_timeout_ms = 60) const {
    BatteryLinkSettings settings;
    settings.port = server_->port();
    settings.response_timeout_ms = response_timeout_ms;
    settings.rtu = line_.has_value();
    settings.baud = 115'200;
    if (line_) {
      EXPECT_TRUE(settings.device.assign(line_->device(1)));
    }
    return settings;
  }
  /// Ends the server; the true state of the battery may be read afterwards.
  const SimulatedBattery& stop() {
    if (thread_.joinable()) {
      ::close(stop_[1]);
      thread_.join();
    }
    return battery_;
  }

  RegisterMap map;
  ScaledClock clock;

 private:
  std::optional<PtyBridge> line_;
  SimulatedBattery battery_;
  std::optional<BatteryServer> server_;
  int stop_[2];
  std::thread thread_;
};

}  // namespace bess
