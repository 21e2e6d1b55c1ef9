// Integer arithmetic of the student: the only place that shifts, rounds and saturates.
// A number x in format Q<f> is x / 2^f. Rounding is to nearest, halves towards +infinity; with the
// arithmetic right shift of C++20 it is equal on x86-64, aarch64 and armhf.
#pragma once

#include <cstdint>

namespace bess {

/// round(value / 2^shift), halves up. Precondition: 0 <= shift < 31 and value + 2^(shift-1) fits.
constexpr std::int32_t rounding_shift_right(std::int32_t value, int shift) {
  if (shift == 0) return value;
  return (value + (std::int32_t{1} << (shift - 1))) >> shift;
}

/// Nearest integer to numerator / denominator, halves up. Precondition: denominator > 0.
template <typename Integer>
constexpr Integer rounding_divide(Integer numerator, Integer denominator) {
  const Integer shifted = numerator + denominator / 2;
  const Integer quotient = shifted / denominator;
  return quotient - (shifted % denominator < 0 ? 1 : 0);  // floor, also below zero
}

template <typename T>
constexpr T clamp_to(T value, T low, T high) {
  return value < low ? low : (value > high ? high : value);
}

}  // namespace bess
