// Register map of a battery as fixed-size data: link, named points, state, commands, watchdog.
// Loaded once from edge/device/maps/*.toml (map_file.h; format: add_a_battery.md), then
// constant. The edge drives the battery with it, and the battery simulator responds with it.
#pragma once

#include <cstdint>

#include "edge/core/base/response_band.h"
#include "edge/device/registers/battery_command.h"
#include "edge/device/registers/register_point.h"

namespace bess {

/// Registers with a unit id of their own.
struct UnitGroup {
  RegisterName name;
  std::int32_t unit = 1;
};

/// Name of a value or of a bit mask.
struct NamedValue {
  std::int8_t point = -1;
  bool is_bit = false;
  std::int64_t value = 0;
  FixedText<23> name;
};

/// Point that proves, before any write, that the map belongs to this device.
struct IdentityCheck {
  std::int8_t point = -1;
  std::int64_t value_min = 0;
  std::int64_t value_max = 0;
  bool may_be_unknown = false;  ///< "not implemented" passes: the device has no value at present
  FixedText<31> text;           ///< required start of a text point
  FixedText<95> hint;
};

/// Power as a sum of terms if the condition holds: of the order in force, or of a device with one
/// register per direction. No term: 0 W.
struct PowerCase {
  struct Term {
    std::int8_t point = -1;
    std::int8_t sign = 1;
  };
  Condition when;  ///< point -1: always
  StaticVector<Term, 6> terms;
};

/// A device counter that must advance; otherwise values are frozen.
struct HeartbeatCounter {
  std::int8_t point = -1;
  std::int32_t max_age_s = 0;
};

/// Data that a simulator needs in addition to the map.
struct SimulatorHints {
  struct Assignment {
    enum class Source : std::uint8_t { kConstant, kPowerMax, kCapacity };
    std::int8_t point = -1;
    Source source = Source::kConstant;
    std::int64_t constant = 0;
  };
  StaticVector<Condition, 4> active;       ///< instead of the map's, if those cannot be read
  StaticVector<PowerCase, 4> order_power;  ///< as above
  StaticVector<Assignment, 16> initial;
  StaticVector<Assignment, 6> at_expiry;  ///< registers that show an expired watchdog
  StaticVector<std::int8_t, 4> apply_on;  ///< while an order runs, only writing these changes it
};

struct RegisterMap {
  RegisterName name;
  RegisterName variant;
  bool is_meter = false;  ///< grid power only; never written
  std::int32_t unit = 1;
  StaticVector<UnitGroup, 4> unit_groups;
  StaticVector<std::uint16_t, 6> models;       ///< SunSpec model ids of points
  StaticVector<std::uint16_t, 4> model_bases;  ///< possible addresses of the "SunS" marker

  std::int32_t port = 502;
  std::int32_t baud = 9'600;
  Parity parity = Parity::kNone;
  std::int32_t stop_bits = 1;
  std::int32_t connect_delay_ms = 0;  ///< from connecting to the first request
  std::int32_t minimum_gap_ms = 0;    ///< from the end of one request to the start of the next
  std::int32_t response_timeout_ms = 1000;
  std::int32_t read_gap_registers_max = 0;  ///< unused registers within one read
  std::int32_t registers_per_read_max = 60;

  std::int32_t charge_w_max = 0;  ///< range of the registers, not of a battery
  std::int32_t discharge_w_max = 0;
  Watchdog watchdog;
  WritePolicy writes;
  ExceptionCodes exceptions;
  ResponseBand response;
  Commissioning commissioning;

  StaticVector<RegisterPoint, kPointsMax> points;
  StaticVector<NamedValue, 96> names;
  StaticVector<std::int8_t, kPointsMax> measure;  ///< points read every cycle
  /// Points that a measurement requires, and protective points: alarms, off-grid, temperatures,
  /// limits. An unknown protective value stops the battery.
  StaticVector<std::int8_t, kPointsMax> required;
  StaticVector<std::int8_t, kPointsMax> protective;
  StaticVector<std::int8_t, kPointsMax> scales;  ///< live values used in writes
  StaticVector<Condition, 4> active;             ///< all hold while the device follows an order
  StaticVector<Condition, 40> alarms;            ///< any of them is an alarm and stops the battery
  StaticVector<Condition, 40> warnings;          ///< any of them is reported and stops nothing
  Condition off_grid;
  HeartbeatCounter alive;
  /// The first case that applies, among those whose points the device has.
  StaticVector<PowerCase, 4> measured_power;
  StaticVector<PowerCase, 4> order_power;
  StaticVector<PowerCase, 4> grid_power;  ///< import is positive; read on demand in a battery map
  StaticVector<IdentityCheck, 8> identity;
  StaticVector<Condition, 4> precondition;  ///< must hold before the first order
  StaticVector<SavedPoint, 6> saved;
  CommandSequence command[kCommandCount];
  SimulatorHints simulator;

  [[nodiscard]] const CommandSequence& sequence(Command c) const {
    return command[static_cast<int>(c)];
  }
  [[nodiscard]] std::int32_t unit_of(const RegisterPoint& point) const {
    return point.unit_group < 0 ? unit : unit_groups[point.unit_group].unit;
  }
};

/// Calls `visit` for each value that a command writes.
template <typename Visit>
constexpr void for_each_written(const RegisterMap& map, const Visit& visit) {
  for (const CommandSequence& sequence : map.command) {
    for (const BlockWrite& write : sequence.writes) {
      for (const WriteValue& value : write.values) visit(value);
    }
  }
}

/// Index of a point, -1 if the map has none of that name.
constexpr int find_point(const RegisterMap& map, std::string_view name) {
  for (int i = 0; i < map.points.size(); ++i) {
    if (map.points[i].name == name) return i;
  }
  return -1;
}

}  // namespace bess
