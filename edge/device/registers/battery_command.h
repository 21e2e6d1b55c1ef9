// What a register map says about ordering: commands as ordered lists of atomic block writes, how
// each is read back, the device's watchdog, and how often its memory may be written.
#pragma once

#include <cstdint>

#include "edge/device/registers/register_point.h"

namespace bess {

/// What stands on the right of "point = ..." in a command.
enum class Argument : std::uint8_t {
  kConstant,
  kPower,           ///< W, charge positive
  kChargePower,     ///< its charging part, 0 when discharging
  kDischargePower,  ///< its discharging part as a positive number
  kSocLimit,        ///< ceiling when charging or idle, floor when discharging
  kSocMin,
  kSocMax,
  kDuration,         ///< s
  kDurationMinutes,  ///< rounded up
  kHeartbeat,        ///< a counter that differs at every write
  kRating,           ///< 100 % of a point with percent_of
  kSaved             ///< what the register held before the first order
};

struct WriteValue {
  std::int8_t point = -1;  ///< index into RegisterMap::points
  Argument argument = Argument::kConstant;
  std::int8_t sign = 1;
  std::uint8_t divisor = 1;   ///< e.g. 3 phases
  std::int8_t plus = -1;      ///< point whose live value is added, e.g. a load behind the same port
  std::int64_t constant = 0;  ///< engineering units
};

enum class ReadBack : std::uint8_t { kExact, kTolerance, kNone };

/// Contiguous points that go out in one request: the device sees all of them or none.
struct BlockWrite {
  StaticVector<WriteValue, 12> values;
  std::uint16_t address = 0;  ///< of the first point (an offset when it belongs to a model)
  std::uint8_t function = 16;
  ReadBack read_back = ReadBack::kExact;
  bool eeprom = false;         ///< at least one of its registers wears
  std::int32_t tolerance = 0;  ///< engineering units
};

enum class Command : std::uint8_t {
  kCharge,
  kIdle,
  kDischarge,
  kRelease,
  kEnable,   ///< once before the first order
  kRefresh,  ///< feeds the watchdog; empty = the order is written again
};
inline constexpr int kCommandCount = 6;

struct CommandSequence {
  StaticVector<BlockWrite, 8> writes;
};

/// Read before the first order and written back by "point = saved".
struct SavedPoint {
  std::int8_t point = -1;
  /// When an earlier process's order is found in force, the register holds that process's value:
  /// then this is written back.
  std::int64_t fallback = 0;
};

struct Watchdog {
  enum class Kind : std::uint8_t {
    kNone,         ///< an order stays for ever
    kDuration,     ///< the order carries its duration
    kRevertTimer,  ///< a timer register of its own; 0 means: never
    kHeartbeat,    ///< a counter must change
    kRewrite       ///< the order itself must be written again
  };
  Kind kind = Kind::kNone;
  std::int32_t duration_s = 0;  ///< from the last feeding to the end of the order; 0 = none
  std::int32_t refresh_s = 0;   ///< longest time between two feedings
  std::int8_t remaining = -1;   ///< point with the seconds left
  bool expiry_visible = true;   ///< RegisterMap::active turns false when it expires
};

struct WritePolicy {
  std::int32_t eeprom_writes_per_day = 0;  ///< orders stop at this less the reserve; 0 = no limit
  std::int32_t reserve = 0;                ///< kept for releases; then no flash is written that day
};

/// What the Modbus exception codes mean on this device, beside those that every device uses
/// (modbus_frame.h).
struct ExceptionCodes {
  StaticVector<std::uint8_t, 6> retry;
  StaticVector<std::uint8_t, 6> not_permitted;
};

/// The sign test: ordered once, the measured power must follow with the same sign.
struct Commissioning {
  std::int32_t power_w = 500;
  std::int32_t duration_s = 30;
  std::int32_t settle_s = 10;           ///< before the measured power counts
  std::int32_t tolerance_percent = 50;  ///< of the ordered power
};

}  // namespace bess
