// What of a device a recording must not tell: it is made to be given away. Kept are the registers
// that the register map names, the walk over SunSpec models, and of a text the beginning that an
// identity check asks for. Everything else becomes 0, of a text X: serial numbers, points that the
// map marks as private, and what lies between the points of one read.
#pragma once

#include <cstdint>

#include "edge/device/registers/live_points.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

class RecordingMask {
 public:
  /// `unit` replaces the map's unit id when it is not negative. `map` must outlive this object.
  RecordingMask(const RegisterMap& map, std::int32_t unit) : map_(map), places_(map, unit) {}

  /// Every exchange in its order. Nothing here allocates.
  void apply(BusExchange& exchange);

 private:
  void keep_text(const BusExchange& exchange, int point, int offset, BusExchange& kept) const;

  const RegisterMap& map_;
  PointPlaces places_;
};

}  // namespace bess
