// The registers of a map's points as they were last seen, and their values where the scale of one
// point stands in another (scale factors, ratings): looked up here.
#pragma once

#include <array>
#include <cstdint>

#include "edge/device/registers/point_codec.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

// Where a map's points lie in a device that is only overheard: exchanges of somebody else's
// connection, or of a recording. SunSpec models are found by following the walk that the master
// makes over them.

class PointPlaces {
 public:
  /// `unit` replaces the map's unit id when it is not negative. `map` must outlive this object.
  PointPlaces(const RegisterMap& map, std::int32_t unit);

  /// Every exchange, in its order: it may be a step of the walk.
  void follow(const BusExchange& exchange);

  /// The newest exchange was a step of the walk: id and length of a model, or "SunS".
  [[nodiscard]] bool is_model_head() const { return is_model_head_; }
  /// Offset of the point's first register among those of the exchange; -1 when it is not wholly
  /// among them, or lies where nobody has looked yet.
  [[nodiscard]] int offset_in(const BusExchange& exchange, int point) const;
  /// False while the point's SunSpec model has not been found.
  [[nodiscard]] bool is_placed(int point) const;
  [[nodiscard]] int address_of(int point) const;
  [[nodiscard]] std::int32_t unit_of(int point) const;
  /// A command of the map writes it.
  [[nodiscard]] bool is_written(int point) const { return is_written_[point]; }

 private:
  void find_written();
  [[nodiscard]] bool begins_walk(const BusExchange& exchange) const;

  const RegisterMap& map_;
  std::int32_t unit_;
  bool is_model_head_ = false;
  int next_head_ = -1;  ///< where the walk goes on; -1 = nobody walks
  std::array<int, decltype(RegisterMap::models)::capacity()> model_start_;  ///< -1 = not found yet
  std::array<bool, kPointsMax> is_written_{};
};

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
