// Point codec: raw registers to and from engineering units. Pure functions: inexpressible values
// are refused, implausible ones are not decoded, nothing wraps.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/device/registers/register_map.h"

namespace bess {

inline constexpr int kBlockRegistersMax = 24;
using RegisterBlock = StaticVector<std::uint16_t, kBlockRegistersMax>;

/// True if the device reports no value for this point.
[[nodiscard]] bool is_not_implemented(const RegisterPoint& point, const std::uint16_t* raw);

/// Contribution of other registers to a point's scale.
struct Scaling {
  std::int32_t exponent = 0;  ///< of ten, from RegisterPoint::scale_from
  std::int64_t rating = 0;    ///< value of RegisterPoint::percent_of
};

/// Value of the registers at `raw`; false if the device reports none, or if it exceeds the
/// plausible range by more than the slack.
[[nodiscard]] bool decode(const RegisterPoint& point, const std::uint16_t* raw, std::int64_t& value,
                          const Scaling& scaling = {});
/// True if the value differs from the registers: clamped, or the maximum instead of none.
[[nodiscard]] bool is_cut(const RegisterPoint& point, const std::uint16_t* raw,
                          const Scaling& scaling);

/// Appends the registers of `value` to `out`. kNotExpressible if the range or the type does not
/// allow it.
Status encode(const RegisterPoint& point, std::int64_t value, Rounding rounding, RegisterBlock& out,
              const Scaling& scaling = {});

/// Characters of a text point without padding.
FixedText<2 * kTextRegistersMax> decode_text(const RegisterPoint& point, const std::uint16_t* raw);

}  // namespace bess
