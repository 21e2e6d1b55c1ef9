// Recording mask: hides private data of a device. Kept are the registers that the map names, the
// walk over SunSpec models, and the beginning of texts that identity checks need. All other
// registers become 0, in a text X: serial numbers, private points, and registers between the points
// of a read.
#pragma once

#include <cstdint>

#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

class RecordingMask {
 public:
  /// `unit` replaces the map's unit id if not negative. `map` must outlive this object.
  RecordingMask(const RegisterMap& map, std::int32_t unit) : map_(map), places_(map, unit) {}

  /// Masks every exchange, in order. Allocates nothing.
  void apply(BusExchange& exchange);

 private:
  void keep_text(const BusExchange& exchange, int point, int offset, BusExchange& kept) const;

  const RegisterMap& map_;
  PointPlaces places_;
};

}  // namespace bess
