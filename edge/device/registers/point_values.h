// Live points: last read registers of a map's points, and their values with live scale factors and
// ratings.
#pragma once

#include <array>
#include <cstdint>

#include "edge/device/registers/point_codec.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

// Point locations in a device whose traffic is only observed: exchanges of another connection, or
// of a recording. SunSpec models are located by following the master's model walk.

class PointPlaces {
 public:
  /// `unit` replaces the map's unit id if not negative. `map` must outlive this object.
  PointPlaces(const RegisterMap& map, std::int32_t unit);

  /// Must receive every exchange in order: it may be a step of the model walk.
  void follow(const BusExchange& exchange);

  /// The newest exchange was a step of the model walk: id and length of a model, or "SunS".
  [[nodiscard]] bool is_model_head() const { return is_model_head_; }
  /// Offset of the point's first register in the exchange; -1 if not entirely included, or not
  /// located yet.
  [[nodiscard]] int offset_in(const BusExchange& exchange, int point) const;
  /// False until the point's SunSpec model is found.
  [[nodiscard]] bool is_placed(int point) const;
  [[nodiscard]] int address_of(int point) const;
  [[nodiscard]] std::int32_t unit_of(int point) const;
  /// A command of the map writes it.
  [[nodiscard]] bool is_written(int point) const { return is_written_[point]; }

 private:
  const RegisterMap& map_;
  std::int32_t unit_;
  bool is_model_head_ = false;
  int next_head_ = -1;  ///< next address of the walk; -1 = no walk
  std::array<int, decltype(RegisterMap::models)::capacity()> model_start_;  ///< -1 = not found yet
  std::array<bool, kPointsMax> is_written_{};
};

struct PointValues {
  std::uint16_t raw[kPointsMax][kPointRegistersMax] = {};
  bool known[kPointsMax] = {};
  bool failed[kPointsMax] = {};  ///< the newest reading failed: the known value is older
  bool absent[kPointsMax] = {};  ///< optional, and not present on this device

  /// Without the values whose newest reading failed.
  [[nodiscard]] PointValues received() const {
    PointValues values = *this;
    for (int i = 0; i < kPointsMax; ++i) values.known[i] = known[i] && !failed[i];
    return values;
  }
  void keep(const RegisterMap& map, int point, const std::uint16_t* registers);
  void forget() { *this = PointValues{}; }
};

/// False while a register needed for the scale is unknown or implausible.
[[nodiscard]] bool live_scaling(const RegisterMap& map, const PointValues& live, int point,
                                Scaling& scaling);
[[nodiscard]] bool live_value(const RegisterMap& map, const PointValues& live, int point,
                              std::int64_t& value);

/// Power of the first case that applies, among those whose points this device has; `cases` is the
/// map's measured_power, order_power or grid_power. False if there is none, or a register is
/// unknown or implausible.
[[nodiscard]] bool live_power(const RegisterMap& map, const StaticVector<PowerCase, 4>& cases,
                              const PointValues& live, std::int64_t& power_w);

/// True if there are conditions and all of them hold.
[[nodiscard]] bool live_all(const RegisterMap& map, const StaticVector<Condition, 4>& conditions,
                            const PointValues& live);

/// Scale factors and ratings at one end of their permitted ranges, for the proof at load and for
/// previewing orders before a device has been read.
PointValues assumed_live_points(const RegisterMap& map, bool high);

}  // namespace bess
