#include "edge/device/registers/point_values.h"

#include <algorithm>

namespace bess {

PointPlaces::PointPlaces(const RegisterMap& map, std::int32_t unit)
    : map_(map), unit_(unit >= 0 ? unit : map.unit) {
  model_start_.fill(-1);
  for_each_written(map, [this](const WriteValue& value) { is_written_[value.point] = true; });
}

void PointPlaces::follow(const BusExchange& exchange) {
  is_model_head_ = false;
  if (map_.models.empty() || exchange.unit != unit_ || exchange.function != 3 ||
      exchange.count != 2 || exchange.outcome != BusOutcome::kAnswered) {
    return;
  }
  const bool begins_walk = std::ranges::count(map_.model_bases, exchange.address) > 0 &&
                           exchange.registers[0] == 0x5375 &&
                           exchange.registers[1] == 0x6E53;  // "SunS"
  if (begins_walk) {
    is_model_head_ = true;
    next_head_ = exchange.address + 2;
  } else if (exchange.address == next_head_) {
    is_model_head_ = true;
    for (int m = 0; m < map_.models.size(); ++m) {
      if (map_.models[m] == exchange.registers[0]) model_start_[m] = exchange.address;
    }
    const bool is_end = exchange.registers[0] == 0xFFFF;
    next_head_ = is_end ? -1 : next_head_ + 2 + exchange.registers[1];
  }
}

int PointPlaces::offset_in(const BusExchange& exchange, int point) const {
  const RegisterPoint& p = map_.points[point];
  // Written points are read back as holding registers, independent of the table of their reading.
  const bool is_of_table = exchange.function == p.read_function ||
                           (is_written_[point] && (exchange.is_write() || exchange.function == 3));
  if (!is_of_table || !is_placed(point) || exchange.unit != unit_of(point)) return -1;
  const int offset = address_of(point) - exchange.address;
  return offset >= 0 && offset + p.registers <= exchange.count ? offset : -1;
}

bool PointPlaces::is_placed(int point) const {
  const int model = map_.points[point].model;
  return model < 0 || model_start_[model] >= 0;
}

int PointPlaces::address_of(int point) const {
  const RegisterPoint& p = map_.points[point];
  return p.address + (p.model < 0 ? 0 : model_start_[p.model]);
}

std::int32_t PointPlaces::unit_of(int point) const {
  const RegisterPoint& p = map_.points[point];
  return p.unit_group < 0 ? unit_ : map_.unit_of(p);
}

void PointValues::keep(const RegisterMap& map, int point, const std::uint16_t* registers) {
  const int count = map.points[point].registers;
  if (count > kPointRegistersMax) return;  // text
  std::copy(registers, registers + count, raw[point]);
  known[point] = true;
  failed[point] = false;
}

// Bounded recursion: a scale factor has no scale of its own, a rating only a scale factor.
bool live_scaling(const RegisterMap& map, const PointValues& live, int point, Scaling& scaling) {
  const RegisterPoint& p = map.points[point];
  std::int64_t exponent = 0;
  if (p.scale_from >= 0 && !live_value(map, live, p.scale_from, exponent)) return false;
  if (p.percent_of >= 0 && !live_value(map, live, p.percent_of, scaling.rating)) return false;
  scaling.exponent = static_cast<std::int32_t>(exponent);
  return true;
}

bool live_value(const RegisterMap& map, const PointValues& live, int point, std::int64_t& value) {
  Scaling scaling;
  if (!live.known[point] || !live_scaling(map, live, point, scaling)) return false;
  return decode(map.points[point], live.raw[point], value, scaling);
}

namespace {

bool needs_absent(const PointValues& live, const PowerCase& c) {
  return (c.when.point >= 0 && live.absent[c.when.point]) ||
         std::ranges::any_of(c.terms,
                             [&](const PowerCase::Term& term) { return live.absent[term.point]; });
}

}  // namespace

bool live_power(const RegisterMap& map, const StaticVector<PowerCase, 4>& cases,
                const PointValues& live, std::int64_t& power_w) {
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
              const PointValues& live) {
  for (const Condition& condition : conditions) {
    std::int64_t value = 0;
    if (!live_value(map, live, condition.point, value) || !condition.holds(value)) return false;
  }
  return !conditions.empty();
}

namespace {

void assume(const RegisterMap& map, int point, std::int64_t value, PointValues& live) {
  Scaling scaling;
  RegisterBlock block;
  if (!live_scaling(map, live, point, scaling)) return;
  if (encode(map.points[point], value, Rounding::kUp, block, scaling) != Status::kOk) return;
  live.keep(map, point, block.data());
}

}  // namespace

PointValues assumed_live_points(const RegisterMap& map, bool high) {
  PointValues live;
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
