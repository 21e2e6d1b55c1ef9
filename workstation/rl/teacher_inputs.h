// What a teacher may see beside the student's five inputs: each by a key of [train], none by
// default. The student never sees them; distillation shows it what the teacher did with them, state
// by state.
#pragma once

#include <algorithm>
#include <cstdint>

#include "workstation/rl/network_input.h"

namespace bess {

inline constexpr int kTeacherInputsMax = 5;

struct TeacherInputs {
  bool previous = false;   ///< last row of the quarter-hour before
  bool earlier = false;    ///< mean of those of the three before that
  bool slope = false;      ///< of the last three minutes
  bool calm = false;       ///< time since a price was far from the level
  bool deviation = false;  ///< of the price from what is usual, by the program that is added to

  [[nodiscard]] int count() const { return previous + earlier + slope + calm + deviation; }
  /// One bit each, for files.
  [[nodiscard]] std::uint32_t bits() const {
    return (previous ? 1U : 0U) | (earlier ? 2U : 0U) | (slope ? 4U : 0U) | (calm ? 8U : 0U) |
           (deviation ? 16U : 0U);
  }
  static TeacherInputs of_bits(std::uint32_t bits) {
    return {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0,
            (bits & 16U) != 0};
  }

  /// Writes count() inputs of 0..1. `deviation_frac` is the program's, if there is one.
  void write(const RecentPrices& recent, const PriceMap& price_map, double deviation_frac,
             float* x) const {
    constexpr float kSlopeReachEurPerMwh = 100;
    constexpr float kCalmReachMin = 240;
    if (previous) *x++ = price_map(double{recent.previous_eur_per_mwh});
    if (earlier) *x++ = price_map(double{recent.earlier_eur_per_mwh});
    if (slope) {
      const float share = recent.slope_eur_per_mwh / kSlopeReachEurPerMwh;
      *x++ = 0.5F + 0.5F * std::clamp(share, -1.0F, 1.0F);
    }
    if (calm) *x++ = recent.calm_min / kCalmReachMin;
    if (deviation) *x++ = static_cast<float>(deviation_frac);
  }
  /// Of a state without a past: as if the price had always been the one that is seen.
  void write_without_past(float mapped_price, double deviation_frac, float* x) const {
    if (previous) *x++ = mapped_price;
    if (earlier) *x++ = mapped_price;
    if (slope) *x++ = 0.5F;
    if (calm) *x++ = 1;
    if (deviation) *x++ = static_cast<float>(deviation_frac);
  }
};

}  // namespace bess
