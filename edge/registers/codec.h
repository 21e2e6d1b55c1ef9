// Raw registers <-> engineering units, and an order -> the registers to write. Pure integer
// functions: what cannot be expressed is refused, nothing wraps.
#pragma once

#include <cstdint>

#include "edge/registers/register_map.h"
#include "shared/status.h"

namespace bess {

inline constexpr int kBlockRegistersMax = 24;
using RegisterBlock = StaticVector<std::uint16_t, kBlockRegistersMax>;

/// What the edge wants of the battery, in the project's own units.
struct PowerOrder {
  std::int32_t power_w = 0;  ///< grid side, charge positive
  std::int32_t soc_min_e4 = 0;
  std::int32_t soc_max_e4 = 10'000;
  std::int32_t duration_s = 0;  ///< of the device's dead-man timer
};

/// How a value between two raw counts is rounded: a ceiling goes down, a floor goes up.
enum class Rounding : std::uint8_t { kNearest, kDown, kUp };

/// Value of the registers at `raw`; false when it lies outside the point's plausible range.
[[nodiscard]] bool decode(const RegisterPoint& point, const std::uint16_t* raw,
                          std::int64_t& value);

/// Appends the registers of `value` to `out`. kNotExpressible when the type cannot hold it.
Status encode(const RegisterPoint& point, std::int64_t value, Rounding rounding,
              RegisterBlock& out);

/// charge, idle or discharge, by the sign of the power.
Command command_of(std::int32_t power_w);

/// Registers of one block write for an order.
Status encode_block(const RegisterMap& map, const BlockWrite& write, const PowerOrder& order,
                    RegisterBlock& out);

/// kOk when every command of the map can express an order of this power.
Status check_expressible(const RegisterMap& map, const PowerOrder& order);

}  // namespace bess
