// A battery's Modbus register map as fixed-size data: named points, commands as ordered lists of
// atomic block writes, timing and dead-man. Loaded once from edge/maps/*.toml (map_file.h), then
// constant: the edge drives the battery with it and the battery simulator answers with it.
//
// One point translates between raw registers and whole engineering units:
//   value = sign * (raw - offset) * scale / scale_divisor        (power: W, charge positive; SoC:
//   1e-4)
// Units are integers, so that neither the edge nor the simulator needs floating point here.
#pragma once

#include <cstdint>

#include "shared/fixed_text.h"
#include "shared/static_vector.h"

namespace bess {

using RegisterName = FixedText<31>;

enum class RegisterType : std::uint8_t { kU16, kS16, kU32, kS32 };
enum class WordOrder : std::uint8_t { kHighFirst, kLowFirst };

struct RegisterPoint {
  RegisterName name;
  FixedText<15> unit;
  std::uint16_t address = 0;  ///< PDU address, 0-based
  std::uint8_t read_function = 3;
  RegisterType type = RegisterType::kU16;
  WordOrder word_order = WordOrder::kHighFirst;
  std::int32_t scale = 1;
  std::int32_t scale_divisor = 1;
  std::int32_t offset = 0;
  std::int32_t sign = 1;       ///< -1 flips the device's sign to ours (charge positive)
  std::int64_t value_min = 0;  ///< plausible range in engineering units, checked at every read
  std::int64_t value_max = 0;

  [[nodiscard]] constexpr int register_count() const {
    return type == RegisterType::kU32 || type == RegisterType::kS32 ? 2 : 1;
  }
};

enum class Argument : std::uint8_t { kConstant, kPower, kSocLimit, kDuration };

struct WriteValue {
  std::int8_t point = -1;  ///< index into RegisterMap::points
  Argument argument = Argument::kConstant;
  std::int64_t constant = 0;  ///< engineering units
};

/// Contiguous points that go out in one request: the device sees all of them or none.
struct BlockWrite {
  StaticVector<WriteValue, 12> values;
  std::uint16_t address = 0;
  std::uint8_t function = 16;
};

enum class Command : std::uint8_t { kCharge, kIdle, kDischarge, kRelease };
inline constexpr int kCommandCount = 4;

struct CommandSequence {
  StaticVector<BlockWrite, 6> writes;
  bool read_back = true;  ///< after the last write, everything written must read back as written
};

/// True when `point` reads `value`.
struct Condition {
  std::int8_t point = -1;  ///< -1 = this map cannot tell
  std::int64_t value = 0;
};

/// A point that proves, before anything is written, that this map belongs to this device.
struct IdentityCheck {
  std::int8_t point = -1;
  std::int64_t value_min = 0;
  std::int64_t value_max = 0;
  FixedText<95> hint;
};

struct RegisterMap {
  RegisterName name;
  RegisterName variant;
  std::int32_t unit = 1;
  std::int32_t minimum_gap_ms = 0;  ///< from the end of one request to the start of the next
  std::int32_t response_timeout_ms = 1000;
  std::int32_t read_gap_registers_max = 0;  ///< unused registers that one read may span
  std::int32_t registers_per_read_max = 60;
  bool one_client = false;

  std::int32_t charge_w_max = 0;  ///< what the registers can express, not what a battery can do
  std::int32_t discharge_w_max = 0;
  std::int32_t dead_man_duration_s = 0;  ///< 0 = the device has no timer
  Condition dead_man_expired;            ///< how expiry is seen
  Condition off_grid;

  StaticVector<RegisterPoint, 32> points;
  StaticVector<std::int8_t, 16> measure;  ///< points read every cycle
  StaticVector<std::int8_t, 4> alarms;    ///< points of which any bit is an alarm
  StaticVector<IdentityCheck, 6> identity;
  CommandSequence command[kCommandCount];

  [[nodiscard]] const CommandSequence& sequence(Command c) const {
    return command[static_cast<int>(c)];
  }
};

/// Index of a point, -1 when the map has none of that name.
constexpr int find_point(const RegisterMap& map, std::string_view name) {
  for (int i = 0; i < map.points.size(); ++i) {
    if (map.points[i].name == name) return i;
  }
  return -1;
}

}  // namespace bess
