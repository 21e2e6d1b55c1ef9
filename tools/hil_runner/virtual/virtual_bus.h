// A device of a virtual run and the bus to it: what the edge's ModbusWire sends to its port arrives
// here, and the answer comes when the device has it, byte by byte if a fault says so.
// virtual_wire.cpp is the edge's end. Over TCP one connection, over RTU a line that keeps what was
// sent too late.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
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

/// Where a device is, and what goes wrong with it.
struct VirtualBusSettings {
  std::int32_t port = 1;
  bool rtu = false;
  std::int32_t response_delay_ms = 20;
  std::vector<BatteryFaultWindow> faults{};
  std::int64_t start_utc_ns = 0;  ///< from which the faults count
};

class VirtualBus {
 public:
  /// All but the settings must outlive this object. One of a port at a time in a process. With a
  /// house the map's grid point shows it, and a meter's map makes this a meter.
  VirtualBus(const VirtualBusSettings& settings, const RegisterMap& map, SimulatedBattery& battery,
             VirtualTime& time, MeteredHouse* house = nullptr);
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;
  ~VirtualBus();
  /// Null: nobody is there.
  static VirtualBus* at(std::int32_t port);

  Status open();
  void close();
  [[nodiscard]] bool is_lost();
  void discard_input();
  Status send(const ModbusFrame& frame);
  Status receive(int count, std::int64_t deadline_ns, ModbusFrame& frame);

  [[nodiscard]] FaultyDevice& device() { return device_; }

  /// Every frame that was sent so far, heard or not, and when.
  [[nodiscard]] std::uint64_t sent() const { return sent_.value(); }

  /// Called with each request and its unspoilt answer, both from the unit's byte on.
  using Witness = std::function<void(std::span<const std::uint8_t> request,
                                     std::span<const std::uint8_t> answer, std::int64_t utc_ns)>;
  void show_to(Witness witness) { witness_ = std::move(witness); }

 private:
  struct FreeContext {
    void operator()(modbus_t* context) const { modbus_free(context); }
  };
  /// A request on the device's desk.
  struct Pending {
    std::int64_t due_ns;
    BusRequest request;
    BatteryFault fault;
    std::size_t window;       ///< of the faults it is of
    std::int64_t connection;  ///< on which it came: a closed one gets no answer
  };
  struct ByteOnTheWay {
    std::int64_t arrives_ns;
    std::uint8_t byte;
  };
  [[nodiscard]] const BatteryFaultWindow& window_of(const Pending& pending) const;
  void answer_due();
  void answer(const Pending& pending);
  void put(const Bytes& bytes, std::int64_t first_ns, std::int64_t gap_ns = 0);
  [[nodiscard]] std::int64_t line_ns(int bytes) const;

  VirtualBusSettings settings_;
  VirtualTime& time_;
  std::int32_t baud_;
  std::unique_ptr<modbus_t, FreeContext> context_;
  FaultyDevice device_;
  std::deque<Pending> pending_;
  std::deque<ByteOnTheWay> input_;
  Witness witness_;
  Signature sent_;
  std::int64_t connection_ = 0;
  bool is_cut_ = false;        ///< by the device
  bool is_half_open_ = false;  ///< the device never answers on this connection again
};

}  // namespace bess
