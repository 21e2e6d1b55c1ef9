// Map commands: ordered lists of atomic block writes, with their read-back, the device's watchdog,
// and the write limits of its memory.
#pragma once

#include <cstdint>

#include "edge/device/registers/register_point.h"

namespace bess {

/// Right side of "point = ..." in a command.
enum class Argument : std::uint8_t {
  kConstant,
  kPower,           ///< W, charge positive
  kChargePower,     ///< charging part, 0 when discharging
  kDischargePower,  ///< discharging part as a positive number
  kSocLimit,        ///< ceiling when charging or idle, floor when discharging
  kSocMin,
  kSocMax,
  kDuration,         ///< s
  kDurationMinutes,  ///< rounded up
  kHeartbeat,        ///< counter that changes at every write
  kRating,           ///< 100 % of a point with percent_of
  kSaved             ///< register value before the first order
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

/// Contiguous points written in one request: the device receives all of them or none.
struct BlockWrite {
  StaticVector<WriteValue, 12> values;
  std::uint8_t function = 16;
  ReadBack read_back = ReadBack::kExact;
  bool eeprom = false;         ///< at least one of its registers has limited write endurance
  std::int32_t tolerance = 0;  ///< engineering units
};

enum class Command : std::uint8_t {
  kCharge,
  kIdle,
  kDischarge,
  kRelease,
  kEnable,   ///< once before the first order
  kRefresh,  ///< refreshes the watchdog; empty = the order is written again
};
inline constexpr int kCommandCount = 6;

struct CommandSequence {
  StaticVector<BlockWrite, 8> writes;
};

/// Read before the first order and written back by "point = saved".
struct SavedPoint {
  std::int8_t point = -1;
  /// If an earlier process's order is found in force, the register holds that process's value: then
  /// this one is restored.
  std::int64_t fallback = 0;
};

struct Watchdog {
  enum class Kind : std::uint8_t {
    kNone,         ///< an order never expires
    kDuration,     ///< the order carries its duration
    kRevertTimer,  ///< a separate timer register; 0 means: never
    kHeartbeat,    ///< a counter must change
    kRewrite       ///< the order itself must be written again
  };
  Kind kind = Kind::kNone;
  std::int32_t duration_s = 0;  ///< from the last refresh to the end of the order; 0 = none
  std::int32_t refresh_s = 0;   ///< longest interval between two refreshes
  std::int8_t remaining = -1;   ///< point with the seconds left
  bool expiry_visible = true;   ///< RegisterMap::active turns false at expiry
};

struct WritePolicy {
  std::int32_t eeprom_writes_per_day = 0;  ///< orders stop at this minus the reserve; 0 = no limit
  std::int32_t reserve = 0;  ///< kept for releases; then flash is not written on that day
};

/// Meaning of Modbus exception codes on this device, in addition to the standard ones
/// (modbus_frame.h).
struct ExceptionCodes {
  StaticVector<std::uint8_t, 6> retry;
  StaticVector<std::uint8_t, 6> not_permitted;
};

/// Sign test: ordered once; the measured power must follow with the same sign.
struct Commissioning {
  std::int32_t power_w = 500;
  std::int32_t duration_s = 30;
  std::int32_t settle_s = 10;           ///< before the measured power counts
  std::int32_t tolerance_percent = 50;  ///< of the ordered power
};

}  // namespace bess
