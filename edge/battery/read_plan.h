// Which registers to ask for in one request: points that lie close together are read as one span.
#pragma once

#include <cstdint>

#include "edge/base/static_vector.h"
#include "edge/battery/modbus_link.h"
#include "edge/registers/register_map.h"

namespace bess {

/// A point where it really lies: unit and address after unit groups, overrides and model walk.
struct PlacedPoint {
  RegisterSpan place;
  std::int8_t point = -1;
};

using PlacedPoints = StaticVector<PlacedPoint, kPointsMax>;
using ReadPlan = StaticVector<RegisterSpan, kPointsMax>;

inline constexpr int kSpanRegistersMax = 120;

/// Merges points into as few spans as the map's gap and size limits allow, over nothing that is
/// `missing` in the device. Sorts `points`.
void plan_reads(const RegisterMap& map, PlacedPoints& points, const PlacedPoints& missing,
                ReadPlan& plan);

/// Offset of a point's first register in a span; -1 when it does not lie in it.
int offset_in(const RegisterSpan& span, const PlacedPoint& point);

}  // namespace bess
