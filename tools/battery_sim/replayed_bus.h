// A recorded device on the simulator's bus: requests as libmodbus received them -> what the device
// did, at what time of the recording, after what latency.
#pragma once

#include <cstdint>

#include "shared/bus_exchange.h"
#include "shared/scaled_clock.h"
#include "tools/battery_sim/bus_reply.h"
#include "tools/battery_sim/recorded_device.h"

namespace bess {

class ReplayedBus {
 public:
  /// In simulated time a request has the recording's time; in real time the first request is made
  /// the recording's first. `device` must outlive this object.
  ReplayedBus(RecordedDevice& device, const ScaledClock& clock) : device_(device), clock_(clock) {}

  [[nodiscard]] bool serves_unit(std::int32_t unit) const { return device_.has_unit(unit); }
  /// What came of it. Prints one line where the recording has no answer.
  BusExchange answer(const BusRequest& request);
  /// How long that took, in wall time: a recording in real time that is replayed faster has shorter
  /// latencies.
  [[nodiscard]] std::int32_t latency_ms(const BusExchange& answer) const;

  /// Unit and PDU of a good reply.
  static Bytes content(const BusExchange& answer);

 private:
  RecordedDevice& device_;
  ScaledClock clock_;
  std::int64_t shift_ns_ = 0;  ///< from now to the recording's time
  bool has_begun_ = false;
};

}  // namespace bess
