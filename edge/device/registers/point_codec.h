// Raw registers <-> engineering units of one point. Pure functions without state: what cannot be
// expressed is refused, what is not plausible is not decoded, nothing wraps.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/device/registers/register_map.h"

namespace bess {

inline constexpr int kBlockRegistersMax = 24;
using RegisterBlock = StaticVector<std::uint16_t, kBlockRegistersMax>;

/// These registers say that the device has no value for this point.
[[nodiscard]] bool is_not_implemented(const RegisterPoint& point, const std::uint16_t* raw);

/// What other registers contribute to a point's scale.
struct Scaling {
  std::int32_t exponent = 0;  ///< of ten, from RegisterPoint::scale_from
  std::int64_t rating = 0;    ///< value of RegisterPoint::percent_of
};

/// Value of the registers at `raw`; false when the device says that it has none, or when it lies
/// outside the point's plausible range by more than its slack.
[[nodiscard]] bool decode(const RegisterPoint& point, const std::uint16_t* raw, std::int64_t& value,
                          const Scaling& scaling = {});
/// The value is not what the registers say: cut to the range, or the largest in place of none.
[[nodiscard]] bool is_cut(const RegisterPoint& point, const std::uint16_t* raw,
                          const Scaling& scaling);

/// Appends the registers of `value` to `out`. kNotExpressible when the range does not allow it or
/// the type cannot hold it.
Status encode(const RegisterPoint& point, std::int64_t value, Rounding rounding, RegisterBlock& out,
              const Scaling& scaling = {});

/// A text point's characters without its padding.
FixedText<2 * kTextRegistersMax> decode_text(const RegisterPoint& point, const std::uint16_t* raw);

}  // namespace bess
