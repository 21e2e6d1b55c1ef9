// Order encoder: from an order to the registers to write. Pure integer functions over the map: an
// order that cannot be expressed is refused, nothing wraps.
#pragma once

#include <cstdint>

#include "edge/core/base/status.h"
#include "edge/core/control/power_order.h"
#include "edge/device/registers/point_codec.h"
#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"

namespace bess {

/// Inputs of a write in addition to the order.
struct WriteContext {
  const PointValues* live = nullptr;   ///< null: the map's assumed scale factors, no live limits
  bool clamp = true;                   ///< to live limits; not in proofs, which cover all values
  const PointValues* saved = nullptr;  ///< null or unknown: the map's fallback
  std::int64_t heartbeat = 0;
};

/// Charge, idle or discharge, by the sign of the power.
Command command_of(std::int32_t power_w);

/// Registers of one block write for an order.
Status encode_block(const RegisterMap& map, const BlockWrite& write, const PowerOrder& order,
                    RegisterBlock& out, const WriteContext& context = {});

/// kOk if every command of the map can express an order of this power.
Status check_expressible(const RegisterMap& map, const PowerOrder& order);

}  // namespace bess
