// The simulated battery (or meter) behind its bus, without the bus: registers that answer, and the
// faults that change what they hold or what is answered. Between battery_server, which has the
// sockets, or whoever has another bus, and register_image. Time is given with every call.
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

class FaultyDevice {
 public:
  /// All but the schedule must outlive this object. `context` makes the frames; with a `house` the
  /// map's grid point shows it, and a meter's map makes this a meter.
  FaultyDevice(const RegisterMap& map, SimulatedBattery& battery, modbus_t* context,
               const std::vector<FaultSchedule>& faults, bool rtu, std::int64_t start_utc_ns,
               MeteredHouse* house = nullptr);

  [[nodiscard]] bool serves_unit(int unit) const;
  /// A new connection comes in.
  BatteryFault on_connect(std::int64_t utc_ns);
  /// A request comes in: lasting faults come into force, and the registers are brought up to date.
  /// Returns how it is to be answered.
  BatteryFault on_request(const BusRequest& request, std::int64_t utc_ns);
  /// Which of the schedules the last fault was of.
  [[nodiscard]] std::size_t struck() const { return plan_.struck(); }
  /// The bytes of the answer, written registers acted on. A late one is given when it is due.
  Bytes answer(const BusRequest& request, BatteryFault fault, std::int64_t utc_ns);
  Bytes exception(const BusRequest& request, int code) { return reply_->exception(request, code); }
  /// Any answer, framed; its bytes changed by `fault`.
  Bytes frame(const BusRequest& request, const Bytes& unit_and_pdu, BatteryFault fault) {
    return reply_->spoil(request, reply_->frame(request, unit_and_pdu), fault, plan_.random());
  }
  /// Brings the battery to an instant.
  void advance(std::int64_t utc_ns);

 private:
  void make_registers();
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
  MeteredHouse* house_;  ///< null: the battery is nobody else's
  std::int64_t start_utc_ns_;
  std::vector<std::uint16_t> registers_;  ///< holding
  std::vector<std::uint16_t> input_registers_;
  modbus_mapping_t mapping_{};
  std::unique_ptr<RegisterImage> image_;
  std::unique_ptr<BusReply> reply_;
  FaultPlan plan_;
  std::int64_t next_action_ns_;  ///< UTC: of another master, or of the device, on the order
};

}  // namespace bess
