// Simulated battery or meter without its bus: registers, and the faults of their values and of the
// answers. Layer between a bus (battery_server) and register_image. Every call has a time argument.
#pragma once

#include <modbus/modbus.h>

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "edge/device/registers/register_map.h"
#include "tools/simulators/battery_sim/battery_faults.h"
#include "tools/simulators/battery_sim/bus_reply.h"
#include "tools/simulators/battery_sim/house_load.h"
#include "tools/simulators/battery_sim/register_image.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

struct ModbusDeleter {
  void operator()(modbus_t* context) const { modbus_free(context); }
};
using ModbusContext = std::unique_ptr<modbus_t, ModbusDeleter>;

class FaultyDevice {
 public:
  /// All but the schedule must outlive this object. `context` makes the frames; with a `house` the
  /// grid point of the map includes it, and a meter map makes this a meter.
  FaultyDevice(const RegisterMap& map, SimulatedBattery& battery, modbus_t* context,
               const std::vector<FaultSchedule>& faults, bool rtu, std::int64_t start_utc_ns,
               MeteredHouse* house = nullptr);

  [[nodiscard]] bool serves_unit(int unit) const;
  /// Handles a new connection.
  BatteryFault on_connect(std::int64_t utc_ns);
  /// Handles a request: applies lasting faults and updates the registers. Returns the fault of its
  /// answer.
  BatteryFault on_request(const BusRequest& request, std::int64_t utc_ns);
  /// Schedule of the last fault.
  [[nodiscard]] std::size_t struck() const { return plan_.struck(); }
  /// Bytes of the answer, after the effect of a write. Call for a late answer when it is due.
  Bytes answer(const BusRequest& request, BatteryFault fault, std::int64_t utc_ns);
  Bytes exception(const BusRequest& request, int code) { return reply_.exception(request, code); }
  /// Frame of any answer, changed by `fault`.
  Bytes frame(const BusRequest& request, const Bytes& unit_and_pdu, BatteryFault fault) {
    return reply_.spoil(request, reply_.frame(request, unit_and_pdu), fault, plan_.random());
  }
  /// Advances the battery to an instant.
  void advance(std::int64_t utc_ns);

 private:
  [[nodiscard]] std::unique_lock<std::mutex> hold_plant() const;
  void refresh(std::int64_t utc_ns);
  void show_grid_as_of(std::int64_t utc_ns);
  void live_until(std::int64_t utc_ns);
  void apply_lasting_faults(std::int64_t utc_ns);
  [[nodiscard]] double gain(std::int64_t utc_ns) const;
  void act_on_order(std::int64_t utc_ns);
  Bytes right_answer(const BusRequest& request, bool keep_registers);
  void change_values(BatteryFault fault, std::int64_t utc_ns);
  [[nodiscard]] double elapsed_s(std::int64_t utc_ns) const {
    return static_cast<double>(utc_ns - start_utc_ns_) / 1e9;
  }

  const RegisterMap& map_;
  SimulatedBattery& battery_;
  MeteredHouse* house_;  ///< null: no other thread uses the battery
  std::int64_t start_utc_ns_;
  std::vector<std::uint16_t> registers_;  ///< holding
  std::vector<std::uint16_t> input_registers_;
  modbus_mapping_t mapping_{};
  RegisterImage image_;
  BusReply reply_;
  FaultPlan plan_;
  std::int64_t next_action_ns_;  ///< UTC of the next action on the order
};

}  // namespace bess
