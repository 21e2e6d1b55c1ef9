// The battery behind a Modbus link, driven through a register map: measurements are gathered in few
// reads, an order becomes the map's sequence of writes and is read back.
#pragma once

#include <cstdint>

#include "edge/control_types.h"
#include "edge/modbus_link.h"
#include "edge/registers/codec.h"
#include "edge/registers/register_map.h"
#include "shared/scaled_clock.h"
#include "shared/status.h"

namespace bess {

struct IdentityFailure {
  int check = 0;  ///< index into RegisterMap::identity
  std::int64_t value = 0;
};

class ModbusBattery {
 public:
  /// `map` must outlive this object.
  ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map, const ScaledClock& clock);
  ModbusBattery(const ModbusBattery&) = delete;
  ModbusBattery& operator=(const ModbusBattery&) = delete;

  /// Connects if needed and reads everything that the map measures.
  Status read(BatteryMeasurement& measurement);
  /// Writes an order and reads it back.
  Status order(const PowerOrder& order);
  /// Gives the battery back to its own mode and reads that back.
  Status release();
  /// Reads the map's identity checks; on kImplausible `failure` says which one and what was read.
  /// `read` fails until this has succeeded once, so nothing is ever ordered of an unknown device.
  Status check_identity(IdentityFailure& failure);

  /// How often `refresh` must be called while an order is in force; 0 = each cycle's order is enough.
  [[nodiscard]] std::int32_t refresh_interval_s() const { return 0; }
  Status refresh() { return Status::kOk; }
  [[nodiscard]] BatteryCounters counters() const { return {}; }

  /// Gives the one connection free; the next request opens it again.
  void close() { link_.close(); }

 private:
  static constexpr int kSpanRegistersMax = 120;

  void plan_reads();
  Status run_command(Command command, const PowerOrder& order);
  Status run_command_once(Command command, const PowerOrder& order);
  Status verify_command(const CommandSequence& sequence, const PowerOrder& order);
  Status read_point(int point, std::int64_t& value);
  Status read_span_values(const RegisterSpan& span, BatteryMeasurement& measurement);
  void store(int point, std::int64_t value, BatteryMeasurement& measurement) const;

  ModbusLink link_;
  const RegisterMap& map_;
  std::int32_t unit_;
  bool identified_ = false;
  StaticVector<RegisterSpan, 16> spans_;

  // Points with a meaning for the controller, by name; -1 = not in this map.
  int soc_, power_, capacity_, charge_limit_, discharge_limit_, temperature_min_, temperature_max_;
};

}  // namespace bess
