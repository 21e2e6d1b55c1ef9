// The registers of a map's points as they were last seen, and their values where the scale of one
// point stands in another (scale factors, ratings): looked up here.
#pragma once

#include <cstdint>

#include "edge/registers/point_codec.h"

namespace bess {

struct LivePoints {
  std::uint16_t raw[kPointsMax][kPointRegistersMax] = {};
  bool known[kPointsMax] = {};
  bool failed[kPointsMax] = {};  ///< the newest reading of it did not come: what is known is older
  bool absent[kPointsMax] = {};  ///< optional, and this device does not have it

  void keep(const RegisterMap& map, int point, const std::uint16_t* registers);
  void forget() { *this = LivePoints{}; }
};

/// False while a register that the scale needs is unknown or implausible.
[[nodiscard]] bool live_scaling(const RegisterMap& map, const LivePoints& live, int point,
                                Scaling& scaling);
[[nodiscard]] bool live_value(const RegisterMap& map, const LivePoints& live, int point,
                              std::int64_t& value);

/// The first case that holds, of those whose points this device has: `cases` is the map's
/// measured_power or order_power. False when there is none, or when a register that it needs is
/// unknown or implausible.
[[nodiscard]] bool live_power(const RegisterMap& map, const StaticVector<PowerCase, 4>& cases,
                              const LivePoints& live, std::int64_t& power_w);

/// Whether every condition holds; false as well when there is none.
[[nodiscard]] bool live_all(const RegisterMap& map, const StaticVector<Condition, 4>& conditions,
                            const LivePoints& live);

/// The scale factors and ratings that a map allows at one end of their ranges, for the proof at
/// load and for printing orders before a device has been read.
LivePoints assumed_live_points(const RegisterMap& map, bool high);

}  // namespace bess
