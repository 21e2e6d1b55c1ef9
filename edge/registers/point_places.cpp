#include "edge/registers/point_places.h"

#include <algorithm>

namespace bess {

PointPlaces::PointPlaces(const RegisterMap& map, std::int32_t unit)
    : map_(map), unit_(unit >= 0 ? unit : map.unit) {
  model_start_.fill(-1);
  find_written();
}

void PointPlaces::find_written() {
  for (const CommandSequence& sequence : map_.command) {
    for (const BlockWrite& write : sequence.writes) {
      for (const WriteValue& value : write.values) is_written_[value.point] = true;
    }
  }
}

bool PointPlaces::begins_walk(const BusExchange& exchange) const {
  return std::find(map_.model_bases.begin(), map_.model_bases.end(), exchange.address) !=
             map_.model_bases.end() &&
         exchange.registers[0] == 0x5375 && exchange.registers[1] == 0x6E53;  // "SunS"
}

void PointPlaces::follow(const BusExchange& exchange) {
  is_model_head_ = false;
  if (map_.models.empty() || exchange.unit != unit_ || exchange.function != 3 ||
      exchange.count != 2 || exchange.outcome != BusOutcome::kAnswered) {
    return;
  }
  if (begins_walk(exchange)) {
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
  // What is written is read back as a holding register, whatever table the point is measured from.
  const bool is_of_table = exchange.function == p.read_function ||
                           (is_written_[point] && (exchange.is_write() || exchange.function == 3));
  if (!is_of_table || !is_placed(point) || exchange.unit != unit_of(point)) return -1;
  const int offset = address_of(point) - exchange.address;
  return offset >= 0 && offset + p.register_count() <= exchange.count ? offset : -1;
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

}  // namespace bess
