// Monotone price map of the network input: mean of the training days' cumulative distribution and
// the straight line over the lattice range, for resolution where prices are frequent and a positive
// slope everywhere. Piecewise linear over whole EUR/MWh; teacher and student use the same table,
// the student in Q14.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/units_and_limits.h"

namespace bess {

class PriceMap {
 public:
  /// Fits to observed prices of training decisions (at least one).
  static PriceMap fit(const std::vector<double>& observed_eur_per_mwh);
  /// Rebuilds the map from its table; throws UserError unless it increases strictly.
  explicit PriceMap(const std::array<std::int16_t, kPriceCount>& table);

  /// Network input 0..1; prices outside the lattice are clamped, those between lattice points
  /// interpolated.
  [[nodiscard]] float operator()(double price_eur_per_mwh) const;
  /// Inverse: price of a network input, EUR/MWh.
  [[nodiscard]] double price_of(float input) const;
  /// Q14 value of each lattice price, strictly increasing.
  [[nodiscard]] const std::array<std::int16_t, kPriceCount>& table() const { return table_; }

 private:
  std::array<std::int16_t, kPriceCount> table_;
};

}  // namespace bess
