// Device of a virtual run and its bus: receives the frames of the edge's ModbusWire
// (virtual_wire.cpp) and delivers answers when they are due, byte by byte for some faults. TCP: one
// connection; RTU: a line that keeps late bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "edge/core/base/status.h"
#include "edge/device/battery/modbus_frame.h"
#include "edge/device/registers/register_map.h"
#include "shared/signature.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/virtual/virtual_time.h"
#include "tools/simulators/battery_sim/faulty_device.h"

namespace bess {

/// Port and faults of a device.
struct VirtualBusSettings {
  std::int32_t port = 1;
  bool rtu = false;
  std::int32_t response_delay_ms = 20;
  std::vector<FaultSchedule> faults{};
  std::int64_t start_utc_ns = 0;  ///< start of the fault times
};

class VirtualBus {
 public:
  /// All but the settings must outlive this object. One bus per port in a process. With a house the
  /// grid point of the map includes it; a meter map makes this a meter.
  VirtualBus(const VirtualBusSettings& settings, const RegisterMap& map, SimulatedBattery& battery,
             VirtualTime& time, MeteredHouse* house = nullptr);
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;
  ~VirtualBus();
  /// Null: no bus at this port.
  static VirtualBus* at(std::int32_t port);

  Status open();
  void close();
  [[nodiscard]] bool is_lost();
  void discard_input();
  Status send(const ModbusFrame& frame);
  Status receive(int count, std::int64_t deadline_ns, ModbusFrame& frame);

  [[nodiscard]] FaultyDevice& device() { return device_; }

  /// Checksum of all sent frames and their times.
  [[nodiscard]] std::uint64_t sent() const { return sent_.value(); }

  /// Called with each request and its correct answer, both from the unit byte on.
  using WireListener =
      std::function<void(std::span<const std::uint8_t> request,
                         std::span<const std::uint8_t> answer, std::int64_t utc_ns)>;
  void show_to(WireListener listener) { listener_ = std::move(listener); }

 private:
  /// Request in processing.
  struct Pending {
    std::int64_t connection = 0;  ///< of the request; a closed one gets no answer
    BusRequest request{};
    BatteryFault fault = BatteryFault::kNone;
    std::size_t window = 0;  ///< index of the fault window
    std::int64_t due_ns = 0;
  };
  struct ByteInTransit {
    std::int64_t arrives_ns;
    std::uint8_t byte;
  };
  [[nodiscard]] const FaultSchedule& window_of(const Pending& pending) const;
  void answer_due();
  void answer(const Pending& pending);
  void put(const Bytes& bytes, std::int64_t first_ns, std::int64_t gap_ns = 0);
  [[nodiscard]] std::int64_t line_ns(int bytes) const;

  VirtualBusSettings settings_;
  VirtualTime& time_;
  std::int32_t baud_;
  ModbusContext context_;
  FaultyDevice device_;
  std::deque<Pending> pending_;
  std::deque<ByteInTransit> input_;
  WireListener listener_;
  Signature sent_;
  std::int64_t connection_ = 0;
  bool is_cut_ = false;        ///< by the device
  bool is_half_open_ = false;  ///< the device never answers on this connection again
};

}  // namespace bess
