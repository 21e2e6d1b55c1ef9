// Register point: location of one named value of a register map, and its conversion to integer
// engineering units. Fixed-size data, filled once from edge/device/maps/*.toml, then constant.
//
//   value = sign * (raw - offset) * scale / scale_divisor * 10^scale_from  [* percent_of / 100]
//
// Values are integers in project units (power: W, charge positive; SoC: 1e-4), so that neither
// guard nor student uses floating point; only f32 registers are converted here.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "shared/fixed_text.h"

namespace bess {

// Parity of a serial line, set by a register map or the operator.

enum class Parity : std::uint8_t { kNone, kEven, kOdd };

using RegisterName = FixedText<31>;

inline constexpr int kPointsMax = 48;
inline constexpr int kPointRegistersMax = 4;  ///< of a number; texts are longer
inline constexpr int kTextRegistersMax = 16;

enum class RegisterType : std::uint8_t { kU16, kS16, kU32, kS32, kU64, kF32, kText };
enum class WordOrder : std::uint8_t { kHighFirst, kLowFirst };

/// Rounding of a value between two raw counts. kAuto: a SoC ceiling down, a SoC floor up, others to
/// the nearest.
enum class Rounding : std::uint8_t { kNearest, kDown, kUp };

struct RegisterPoint {
  RegisterName name;
  std::uint16_t address = 0;    ///< PDU address, 0-based; with a model: offset from its start
  std::int8_t model = -1;       ///< index into RegisterMap::models; -1 = an absolute address
  std::int8_t unit_group = -1;  ///< index into RegisterMap::unit_groups; -1 = the map's unit id
  std::uint8_t registers = 1;   ///< how many registers hold it
  std::uint8_t read_function = 3;
  RegisterType type = RegisterType::kU16;
  WordOrder word_order = WordOrder::kHighFirst;
  bool eeprom = false;          ///< limited write endurance: only changes are written, and counted
  bool optional = false;        ///< omitted silently on devices without it
  bool is_private = false;      ///< personal data such as a serial number: hidden in a recording
  std::int8_t scale_from = -1;  ///< point that holds the decimal exponent
  std::int8_t percent_of = -1;  ///< the register counts per cent of this point
  std::int8_t clamp_to = -1;    ///< written values are limited to +- this point's live value
  std::uint64_t mask = 0;       ///< a bit field: masked, then shifted down; 0 = all bits
  std::int32_t scale = 1;
  std::int32_t scale_divisor = 1;
  std::int32_t offset = 0;
  std::int32_t sign = 1;       ///< -1 inverts the device's sign (ours: charge positive)
  std::int32_t step = 1;       ///< written values are truncated to multiples of this
  std::int32_t max_age_s = 0;  ///< a younger value is not read again; 0 = always read
  std::int64_t value_min = 0;  ///< plausible range when read, permitted range when written
  std::int64_t value_max = 0;
  std::int64_t slack = 0;       ///< values read beyond the range by at most this are clamped
  std::int32_t raw_at_max = 0;  ///< raw value written for the maximum: no limit; 0 = none
  bool unknown_is_max = false;  ///< "not implemented" is read as the maximum
  StaticVector<std::uint64_t, 3> not_implemented;  ///< raw values that mean: no value
};

/// Condition on the value of `point`.
struct Condition {
  enum class Test : std::uint8_t { kEqual, kNotEqual, kHasBits };
  std::int8_t point = -1;  ///< -1 = not available in this map
  Test test = Test::kEqual;
  std::int64_t value = 0;

  [[nodiscard]] constexpr bool holds(std::int64_t read) const {
    if (test == Test::kHasBits) return (read & value) != 0;
    return (read == value) == (test == Test::kEqual);
  }
};

}  // namespace bess
