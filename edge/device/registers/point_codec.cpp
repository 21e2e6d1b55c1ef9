#include "edge/device/registers/point_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace bess {
namespace {

/// Factor from raw counts to a value.
struct Ratio {
  std::int64_t numerator = 1;
  std::int64_t denominator = 1;
  bool valid = true;

  void times(std::int64_t factor) {
    valid = valid && !__builtin_mul_overflow(numerator, factor, &numerator);
  }
  void over(std::int64_t factor) {
    valid = valid && factor != 0 && !__builtin_mul_overflow(denominator, factor, &denominator);
  }
};

Ratio ratio_of(const RegisterPoint& point, const Scaling& scaling) {
  constexpr int kExponentMax = 10;  // SunSpec maximum
  Ratio ratio{.numerator = point.scale, .denominator = point.scale_divisor};
  if (point.scale_from >= 0) {
    if (std::abs(scaling.exponent) > kExponentMax) ratio.valid = false;
    for (int i = 0; ratio.valid && i < std::abs(scaling.exponent); ++i) {
      scaling.exponent > 0 ? ratio.times(10) : ratio.over(10);
    }
  }
  if (point.percent_of >= 0) {
    ratio.times(scaling.rating);
    ratio.over(100);
  }
  return ratio;
}

std::int64_t floor_divide(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t quotient = numerator / denominator;
  return quotient - (numerator % denominator < 0 ? 1 : 0);
}

/// `denominator` is positive.
std::int64_t divide(std::int64_t numerator, std::int64_t denominator, Rounding rounding) {
  const std::int64_t down = floor_divide(numerator, denominator);
  const std::int64_t rest = numerator - down * denominator;
  if (rest == 0 || rounding == Rounding::kDown) return down;
  if (rounding == Rounding::kUp) return down + 1;
  return rest >= denominator - rest ? down + 1 : down;
}

/// With an inverted sign, rounding the value down rounds the raw count up.
Rounding mirrored(Rounding rounding) {
  if (rounding == Rounding::kDown) return Rounding::kUp;
  return rounding == Rounding::kUp ? Rounding::kDown : rounding;
}

std::uint64_t bits_of(const RegisterPoint& point, const std::uint16_t* raw) {
  std::uint64_t bits = 0;
  const bool high_first = point.word_order == WordOrder::kHighFirst;
  for (int i = 0; i < point.registers; ++i) {
    bits = bits << 16 | raw[high_first ? i : point.registers - 1 - i];
  }
  return bits;
}

bool integer_of(const RegisterPoint& point, std::uint64_t bits, std::int64_t& raw) {
  if (point.mask != 0) bits = (bits & point.mask) >> std::countr_zero(point.mask);
  switch (point.type) {
    case RegisterType::kS16:
      raw = static_cast<std::int16_t>(bits);
      return true;
    case RegisterType::kS32:
      raw = static_cast<std::int32_t>(bits);
      return true;
    case RegisterType::kU16:
    case RegisterType::kU32:
    case RegisterType::kU64:
      raw = static_cast<std::int64_t>(bits);
      return bits <= INT64_MAX;
    case RegisterType::kF32:
    case RegisterType::kText:
      break;
  }
  return false;
}

bool decode_float(const RegisterPoint& point, std::uint64_t bits, const Ratio& ratio,
                  std::int64_t& value) {
  constexpr double kExact = 9e15;  // whole numbers below this are exact in a double
  const double raw = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  const double scaled = point.sign * (raw - point.offset) * static_cast<double>(ratio.numerator) /
                        static_cast<double>(ratio.denominator);
  if (!std::isfinite(scaled) || std::abs(scaled) > kExact) return false;
  value = std::llround(scaled);
  return true;
}

bool decode_integer(const RegisterPoint& point, std::uint64_t bits, const Ratio& ratio,
                    std::int64_t& value) {
  std::int64_t raw = 0;
  if (!integer_of(point, bits, raw)) return false;
  std::int64_t scaled = 0;
  if (__builtin_sub_overflow(raw, std::int64_t{point.offset}, &scaled) ||
      __builtin_mul_overflow(scaled, point.sign * ratio.numerator, &scaled)) {
    return false;
  }
  value = divide(scaled, ratio.denominator, Rounding::kNearest);
  return true;
}

/// Raw integers of a type, in the order of RegisterType; none of float and text.
struct RawRange {
  std::int64_t least, most;
};
constexpr RawRange kRawRanges[] = {{0, UINT16_MAX}, {INT16_MIN, INT16_MAX},
                                   {0, UINT32_MAX}, {INT32_MIN, INT32_MAX},
                                   {0, INT64_MAX},  {0, -1},
                                   {0, -1}};

bool fits(const RegisterPoint& point, std::int64_t raw) {
  const auto [least, most] = kRawRanges[static_cast<int>(point.type)];
  return raw >= least && raw <= most;
}

Status append(const RegisterPoint& point, std::uint64_t bits, RegisterBlock& out) {
  const int count = point.registers;
  for (int i = 0; i < count; ++i) {
    const int word = point.word_order == WordOrder::kHighFirst ? count - 1 - i : i;
    if (!out.try_push_back(static_cast<std::uint16_t>(bits >> 16 * word))) {
      return Status::kTooLarge;
    }
  }
  return Status::kOk;
}

Status encode_float(const RegisterPoint& point, std::int64_t value, const Ratio& ratio,
                    RegisterBlock& out) {
  const double raw = point.offset + point.sign * static_cast<double>(value) *
                                        static_cast<double>(ratio.denominator) /
                                        static_cast<double>(ratio.numerator);
  return append(point, std::bit_cast<std::uint32_t>(static_cast<float>(raw)), out);
}

}  // namespace

bool is_not_implemented(const RegisterPoint& point, const std::uint16_t* raw) {
  const std::uint64_t bits = bits_of(point, raw);
  return std::ranges::count(point.not_implemented, bits) > 0;
}

bool decode(const RegisterPoint& point, const std::uint16_t* raw, std::int64_t& value,
            const Scaling& scaling) {
  const Ratio ratio = ratio_of(point, scaling);
  if (!ratio.valid) return false;
  if (is_not_implemented(point, raw)) {
    value = point.value_max;
    return point.unknown_is_max;
  }
  const std::uint64_t bits = bits_of(point, raw);
  const bool decoded = point.type == RegisterType::kF32 ? decode_float(point, bits, ratio, value)
                                                        : decode_integer(point, bits, ratio, value);
  const bool is_plausible =
      decoded && value >= point.value_min - point.slack && value <= point.value_max + point.slack;
  value = std::clamp(value, point.value_min, point.value_max);
  return is_plausible;
}

bool is_cut(const RegisterPoint& point, const std::uint16_t* raw, const Scaling& scaling) {
  RegisterPoint strict = point;
  strict.slack = 0;
  strict.unknown_is_max = false;
  std::int64_t value = 0;
  return decode(point, raw, value, scaling) && !decode(strict, raw, value, scaling);
}

Status encode(const RegisterPoint& point, std::int64_t value, Rounding rounding, RegisterBlock& out,
              const Scaling& scaling) {
  const Ratio ratio = ratio_of(point, scaling);
  if (value < point.value_min || value > point.value_max || !ratio.valid || ratio.numerator <= 0) {
    return Status::kNotExpressible;
  }
  if (point.percent_of >= 0 && (value > scaling.rating || value < -scaling.rating)) {
    return Status::kNotExpressible;
  }
  value = value / point.step * point.step;
  if (point.type == RegisterType::kF32) return encode_float(point, value, ratio, out);
  std::int64_t raw = 0;
  if (__builtin_mul_overflow(point.sign * value, ratio.denominator, &raw)) {
    return Status::kNotExpressible;
  }
  raw = divide(raw, ratio.numerator, point.sign < 0 ? mirrored(rounding) : rounding);
  const bool is_bound = point.raw_at_max == 0 || value != point.value_max;
  if (!is_bound) raw = point.raw_at_max - point.offset;
  if (__builtin_add_overflow(raw, std::int64_t{point.offset}, &raw) || !fits(point, raw)) {
    return Status::kNotExpressible;
  }
  return append(point, static_cast<std::uint64_t>(raw), out);
}

FixedText<2 * kTextRegistersMax> decode_text(const RegisterPoint& point, const std::uint16_t* raw) {
  char text[2 * kTextRegistersMax];
  int size = 0;
  for (int i = 0; i < point.registers; ++i) {
    const int word = point.word_order == WordOrder::kHighFirst ? i : point.registers - 1 - i;
    text[size++] = static_cast<char>(raw[word] >> 8);
    text[size++] = static_cast<char>(raw[word] & 0xFF);
  }
  while (size > 0 && (text[size - 1] == '\0' || text[size - 1] == ' ')) --size;
  return std::string_view(text, static_cast<std::size_t>(size));
}

}  // namespace bess
