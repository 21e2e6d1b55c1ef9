// Network input of a state [SPEC 4]: T_qh/14, qh/95, (mo-1)/11, SoC over its 0..1 range, mapped
// price. The scales are those of the integer student (shared/nn/student_net.h), so that a float
// student has the same inputs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/nn/student_net.h"
#include "shared/units_and_limits.h"
#include "workstation/data/env/market_steps.h"

namespace bess {

// Monotone price map of the network input: mean of the training days' cumulative distribution and
// the straight line over the lattice range, for resolution where prices are frequent and a positive
// slope everywhere. Piecewise linear over whole EUR/MWh; teacher and student use the same table,
// the student in Q14.

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

inline constexpr int kNetworkInputs = kStudentInputs;

/// Battery-independent part of a network input.
struct NetworkContext {
  float minute_of_quarter_hour, quarter_hour, context_class, price;
};

inline float scaled_input(int value, int scale) {
  return static_cast<float>(value * scale) / static_cast<float>(kInputOne);
}
inline float scaled_soc(double soc_frac) {
  return static_cast<float>(soc_frac * (kSocCount - 1) * kSocScale / kInputOne);
}

inline NetworkContext network_context(int minute_of_quarter_hour, int quarter_hour,
                                      int context_class, float mapped_price) {
  return {scaled_input(minute_of_quarter_hour, kMinuteOfQuarterHourScale),
          scaled_input(quarter_hour, kQuarterHourScale),
          scaled_input(context_class - 1, kContextClassScale), mapped_price};
}
inline NetworkContext network_context(const MarketStep& step, const PriceMap& price_map,
                                      const ContextClasses& classes) {
  return network_context(step.minute_of_quarter_hour, step.quarter_hour,
                         classes.class_of(step.month, step.level_centi_eur_per_mwh),
                         price_map(step.observed_eur_per_mwh));
}

/// Writes the five inputs in the student's order.
inline void write_input(const NetworkContext& context, double soc_frac, float* x) {
  x[0] = context.minute_of_quarter_hour;
  x[1] = context.quarter_hour;
  x[2] = context.context_class;
  x[3] = scaled_soc(soc_frac);
  x[4] = context.price;
}

}  // namespace bess
