// Where a map's points lie in a device that is only overheard: exchanges of somebody else's
// connection, or of a recording. SunSpec models are found by following the walk that the master
// makes over them.
#pragma once

#include <array>
#include <cstdint>

#include "edge/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

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

}  // namespace bess
