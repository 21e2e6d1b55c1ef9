#include "edge/device/registers/codec.h"

#include <algorithm>
#include <cstdlib>

namespace bess {
namespace {

/// A SoC limit is a ceiling for a charging battery and a floor for a discharging one.
std::int64_t argument_of(Argument argument, const PowerOrder& order, std::int64_t heartbeat) {
  const std::int64_t power_w = order.power_w;
  switch (argument) {
    case Argument::kPower:
      return power_w;
    case Argument::kChargePower:
      return std::max<std::int64_t>(power_w, 0);
    case Argument::kDischargePower:
      return std::max<std::int64_t>(-power_w, 0);
    case Argument::kSocLimit:
      return power_w < 0 ? order.soc_min_e4 : order.soc_max_e4;
    case Argument::kSocMin:
      return order.soc_min_e4;
    case Argument::kSocMax:
      return order.soc_max_e4;
    case Argument::kDuration:
      return order.duration_s;
    case Argument::kDurationMinutes:
      return (std::int64_t{order.duration_s} + 59) / 60;
    case Argument::kHeartbeat:
      return heartbeat;
    case Argument::kConstant:
    case Argument::kRating:
    case Argument::kSaved:
      break;
  }
  return 0;
}

Rounding rounding_of(Argument argument, const PowerOrder& order) {
  const bool floor =
      argument == Argument::kSocMin || (argument == Argument::kSocLimit && order.power_w < 0);
  const bool ceiling = argument == Argument::kSocMax || argument == Argument::kSocLimit;
  if (floor) return Rounding::kUp;
  return ceiling ? Rounding::kDown : Rounding::kNearest;
}

std::int64_t fallback_of(const RegisterMap& map, int point) {
  for (const SavedPoint& saved : map.saved) {
    if (saved.point == point) return saved.fallback;
  }
  return 0;
}

/// The register's raw words: restored exactly as found.
Status append_saved(const RegisterMap& map, int point, const PointValues& saved,
                    RegisterBlock& out) {
  for (int i = 0; i < map.points[point].registers; ++i) {
    if (!out.try_push_back(saved.raw[point][i])) return Status::kTooLarge;
  }
  return Status::kOk;
}

/// Wraps a heartbeat within the range of its point.
std::int64_t wrapped(const RegisterPoint& point, std::int64_t counter) {
  return point.value_min + counter % (point.value_max - point.value_min + 1);
}

Status clamp_to_live(const RegisterMap& map, const RegisterPoint& point, const PointValues& live,
                     std::int64_t& value) {
  std::int64_t limit = 0;
  if (!live_value(map, live, point.clamp_to, limit)) return Status::kImplausible;
  limit = std::abs(limit);
  value = std::clamp(value, -limit, limit);
  return Status::kOk;
}

Status encode_value(const RegisterMap& map, const WriteValue& write, const PowerOrder& order,
                    const WriteContext& context, const PointValues& live, RegisterBlock& out) {
  const RegisterPoint& point = map.points[write.point];
  if (write.argument == Argument::kSaved && context.saved != nullptr &&
      context.saved->known[write.point]) {
    return append_saved(map, write.point, *context.saved, out);
  }
  Scaling scaling;
  if (!live_scaling(map, live, write.point, scaling)) return Status::kImplausible;
  std::int64_t value = write.constant;
  if (write.argument == Argument::kSaved) {
    value = fallback_of(map, write.point);
  } else if (write.argument == Argument::kRating) {
    value = write.sign * scaling.rating;
  } else if (write.argument != Argument::kConstant) {
    value = argument_of(write.argument, order, context.heartbeat);
    if (write.argument == Argument::kHeartbeat) value = wrapped(point, value);
    value = write.sign * value / write.divisor;
  }
  std::int64_t added = 0;
  // Not in proofs: the device limits the sum.
  if (write.plus >= 0 && context.clamp && context.live != nullptr) {
    if (!live_value(map, live, write.plus, added)) return Status::kImplausible;
    value = std::clamp(value + added, point.value_min, point.value_max);
  }
  if (point.clamp_to >= 0 && context.clamp && context.live != nullptr) {
    if (const Status status = clamp_to_live(map, point, live, value); status != Status::kOk) {
      return status;
    }
  }
  return encode(point, value, rounding_of(write.argument, order), out, scaling);
}

}  // namespace

Command command_of(std::int32_t power_w) {
  if (power_w > 0) return Command::kCharge;
  return power_w < 0 ? Command::kDischarge : Command::kIdle;
}

Status encode_block(const RegisterMap& map, const BlockWrite& write, const PowerOrder& order,
                    RegisterBlock& out, const WriteContext& context) {
  out.clear();
  PointValues assumed;
  if (context.live == nullptr) assumed = assumed_live_points(map, false);
  const PointValues& live = context.live == nullptr ? assumed : *context.live;
  for (const WriteValue& value : write.values) {
    const Status status = encode_value(map, value, order, context, live, out);
    if (status != Status::kOk) return status;
  }
  return Status::kOk;
}

Status check_expressible(const RegisterMap& map, const PowerOrder& order) {
  if (order.power_w > map.charge_w_max || order.power_w < -map.discharge_w_max) {
    return Status::kNotExpressible;
  }
  const Command commands[] = {command_of(order.power_w), Command::kEnable, Command::kRefresh,
                              Command::kRelease};
  for (const bool high : {false, true}) {
    const PointValues live = assumed_live_points(map, high);
    for (const Command command : commands) {
      for (const BlockWrite& write : map.sequence(command).writes) {
        RegisterBlock block;
        const Status status =
            encode_block(map, write, order, block, {.live = &live, .clamp = false});
        if (status != Status::kOk) return status;
      }
    }
  }
  return Status::kOk;
}

}  // namespace bess
