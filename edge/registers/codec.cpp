#include "edge/registers/codec.h"

namespace bess {
namespace {

struct RawRange {
  std::int64_t min, max;
};

constexpr RawRange raw_range(RegisterType type) {
  switch (type) {
    case RegisterType::kU16:
      return {0, UINT16_MAX};
    case RegisterType::kS16:
      return {INT16_MIN, INT16_MAX};
    case RegisterType::kU32:
      return {0, UINT32_MAX};
    case RegisterType::kS32:
      return {INT32_MIN, INT32_MAX};
  }
  return {0, 0};
}

std::int64_t floor_divide(std::int64_t numerator, std::int64_t denominator) {
  const std::int64_t quotient = numerator / denominator;
  return quotient - (numerator % denominator < 0 ? 1 : 0);
}

std::int64_t divide(std::int64_t numerator, std::int64_t denominator, Rounding rounding) {
  switch (rounding) {
    case Rounding::kDown:
      return floor_divide(numerator, denominator);
    case Rounding::kUp:
      return -floor_divide(-numerator, denominator);
    case Rounding::kNearest:
      break;
  }
  return floor_divide(numerator + denominator / 2, denominator);
}

std::int64_t raw_of(const RegisterPoint& point, const std::uint16_t* raw) {
  if (point.register_count() == 1) {
    return point.type == RegisterType::kS16 ? static_cast<std::int16_t>(raw[0]) : raw[0];
  }
  const bool high_first = point.word_order == WordOrder::kHighFirst;
  const std::uint32_t high = raw[high_first ? 0 : 1];
  const std::uint32_t low = raw[high_first ? 1 : 0];
  const std::uint32_t bits = high << 16 | low;
  return point.type == RegisterType::kS32 ? std::int64_t{static_cast<std::int32_t>(bits)}
                                          : std::int64_t{bits};
}

/// A SoC limit is a ceiling for a charging battery and a floor for a discharging one.
std::int64_t value_of(const WriteValue& value, const PowerOrder& order, Rounding& rounding) {
  rounding = Rounding::kNearest;
  switch (value.argument) {
    case Argument::kConstant:
      return value.constant;
    case Argument::kPower:
      return order.power_w;
    case Argument::kDuration:
      return order.duration_s;
    case Argument::kSocLimit:
      break;
  }
  const bool floor = order.power_w < 0;
  rounding = floor ? Rounding::kUp : Rounding::kDown;
  return floor ? order.soc_min_e4 : order.soc_max_e4;
}

}  // namespace

bool decode(const RegisterPoint& point, const std::uint16_t* raw, std::int64_t& value) {
  const std::int64_t scaled =
      point.sign * (raw_of(point, raw) - point.offset) * std::int64_t{point.scale};
  value = divide(scaled, point.scale_divisor, Rounding::kNearest);
  return value >= point.value_min && value <= point.value_max;
}

Status encode(const RegisterPoint& point, std::int64_t value, Rounding rounding,
              RegisterBlock& out) {
  const RawRange range = raw_range(point.type);
  const std::int64_t raw =
      point.offset + divide(point.sign * value * point.scale_divisor, point.scale, rounding);
  if (raw < range.min || raw > range.max) return Status::kNotExpressible;
  const auto bits = static_cast<std::uint32_t>(raw);
  const auto high = static_cast<std::uint16_t>(bits >> 16);
  const auto low = static_cast<std::uint16_t>(bits & 0xFFFFu);
  if (point.register_count() == 1) {
    return out.try_push_back(low) ? Status::kOk : Status::kTooLarge;
  }
  const bool high_first = point.word_order == WordOrder::kHighFirst;
  const bool fits =
      out.try_push_back(high_first ? high : low) && out.try_push_back(high_first ? low : high);
  return fits ? Status::kOk : Status::kTooLarge;
}

Command command_of(std::int32_t power_w) {
  if (power_w > 0) return Command::kCharge;
  return power_w < 0 ? Command::kDischarge : Command::kIdle;
}

Status encode_block(const RegisterMap& map, const BlockWrite& write, const PowerOrder& order,
                    RegisterBlock& out) {
  out.clear();
  for (const WriteValue& value : write.values) {
    Rounding rounding = Rounding::kNearest;
    const std::int64_t wanted = value_of(value, order, rounding);
    const Status status = encode(map.points[value.point], wanted, rounding, out);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

Status check_expressible(const RegisterMap& map, const PowerOrder& order) {
  if (order.power_w > map.charge_w_max || order.power_w < -map.discharge_w_max) {
    return Status::kNotExpressible;
  }
  for (const BlockWrite& write : map.sequence(command_of(order.power_w)).writes) {
    RegisterBlock block;
    const Status status = encode_block(map, write, order, block);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

}  // namespace bess
