#include "edge/registers/live_points.h"

#include <algorithm>

namespace bess {

void LivePoints::keep(const RegisterMap& map, int point, const std::uint16_t* registers) {
  const int count = map.points[point].register_count();
  if (count > kPointRegistersMax) return;  // a text
  std::copy(registers, registers + count, raw[point]);
  known[point] = true;
  failed[point] = false;
}

// Bounded: the loader allows a scale factor no scale of its own, and a rating only a scale factor.
bool live_scaling(const RegisterMap& map, const LivePoints& live, int point, Scaling& scaling) {
  const RegisterPoint& p = map.points[point];
  std::int64_t exponent = 0;
  if (p.scale_from >= 0 && !live_value(map, live, p.scale_from, exponent)) return false;
  if (p.percent_of >= 0 && !live_value(map, live, p.percent_of, scaling.rating)) return false;
  scaling.exponent = static_cast<std::int32_t>(exponent);
  return true;
}

bool live_value(const RegisterMap& map, const LivePoints& live, int point, std::int64_t& value) {
  Scaling scaling;
  if (!live.known[point] || !live_scaling(map, live, point, scaling)) return false;
  return decode(map.points[point], live.raw[point], value, scaling);
}

namespace {

bool needs_absent(const LivePoints& live, const PowerCase& c) {
  return (c.when.point >= 0 && live.absent[c.when.point]) ||
         std::any_of(c.terms.begin(), c.terms.end(),
                     [&](const PowerCase::Term& term) { return live.absent[term.point]; });
}

}  // namespace

bool live_power(const RegisterMap& map, const StaticVector<PowerCase, 4>& cases,
                const LivePoints& live, std::int64_t& power_w) {
  for (const PowerCase& c : cases) {
    std::int64_t value = 0;
    if (needs_absent(live, c)) continue;
    if (c.when.point >= 0 && !live_value(map, live, c.when.point, value)) return false;
    if (c.when.point >= 0 && !c.when.holds(value)) continue;
    power_w = 0;
    for (const PowerCase::Term& term : c.terms) {
      if (!live_value(map, live, term.point, value)) return false;
      power_w += term.sign * value;
    }
    return true;
  }
  return false;
}

bool live_all(const RegisterMap& map, const StaticVector<Condition, 4>& conditions,
              const LivePoints& live) {
  for (const Condition& condition : conditions) {
    std::int64_t value = 0;
    if (!live_value(map, live, condition.point, value) || !condition.holds(value)) return false;
  }
  return !conditions.empty();
}

namespace {

void assume(const RegisterMap& map, int point, std::int64_t value, LivePoints& live) {
  Scaling scaling;
  RegisterBlock block;
  if (!live_scaling(map, live, point, scaling)) return;
  if (encode(map.points[point], value, Rounding::kUp, block, scaling) != Status::kOk) return;
  live.keep(map, point, block.data());
}

}  // namespace

LivePoints assumed_live_points(const RegisterMap& map, bool high) {
  LivePoints live;
  for (const RegisterPoint& p : map.points) {
    if (p.scale_from < 0) continue;
    const RegisterPoint& exponent = map.points[p.scale_from];
    assume(map, p.scale_from, high ? exponent.value_max : exponent.value_min, live);
  }
  const std::int64_t rating_w = std::max(map.charge_w_max, map.discharge_w_max);
  for (const RegisterPoint& p : map.points) {
    if (p.percent_of >= 0) assume(map, p.percent_of, rating_w, live);
  }
  return live;
}

}  // namespace bess
