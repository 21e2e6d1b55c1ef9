#include "tools/battery_sim/register_image.h"

#include <cmath>

#include "edge/registers/codec.h"
#include "tools/sim/sim_error.h"

namespace bess {
namespace {

constexpr std::int64_t kModeSocControl = 2;
constexpr std::int64_t kRoomTemperatureDeciC = 200;
constexpr std::int64_t kDefaultDispatchTimeS = 90;  // what the vendor's stop block writes back

int required_point(const RegisterMap& map, std::string_view name) {
  const int point = find_point(map, name);
  if (point < 0) sim_fail("map {}: point \"{}\" is missing", map.name.view(), name);
  if (map.points[point].address + map.points[point].register_count() >
      RegisterImage::kRegisterCount) {
    sim_fail("map {}: point \"{}\" lies above address {}", map.name.view(), name,
             RegisterImage::kRegisterCount);
  }
  return point;
}

}  // namespace

RegisterImage::RegisterImage(const RegisterMap& map, SimulatedBattery& battery,
                             std::span<std::uint16_t> registers)
    : map_(map),
      battery_(battery),
      registers_(registers),
      start_(required_point(map, "dispatch_start")),
      power_(required_point(map, "dispatch_power")),
      mode_(required_point(map, "dispatch_mode")),
      soc_limit_(required_point(map, "dispatch_soc")),
      time_(required_point(map, "dispatch_time")) {
  for (const RegisterPoint& point : map.points) required_point(map, point.name.view());
  set(power_, 0);
  set(find_point(map_, "dispatch_reactive_power"), 0);
  set(time_, kDefaultDispatchTimeS);
}

void RegisterImage::refresh(std::int64_t utc_ns) {
  battery_.advance(utc_ns);
  const BatteryParameters& p = battery_.parameters();
  set(find_point(map_, "soc"), std::llround(battery_.soc_frac() * 1e4));
  set(find_point(map_, "battery_power"), std::llround(battery_.power_w()));
  set(find_point(map_, "capacity"), std::llround(p.capacity_wh));
  set(find_point(map_, "charge_power_max"), std::llround(p.power_w_max));
  set(find_point(map_, "discharge_power_max"), std::llround(p.power_w_max));
  set(find_point(map_, "temperature_min"), kRoomTemperatureDeciC);
  set(find_point(map_, "temperature_max"), kRoomTemperatureDeciC);
  set(find_point(map_, "work_mode"), 1);
  if (!battery_.dispatch_active()) set(start_, 0);  // expiry is seen here
  was_started_ = battery_.dispatch_active();
}

void RegisterImage::apply_write(int address, int count) {
  if (value(start_) != 1) {
    battery_.stop_dispatch();
    return;
  }
  // Parameters wait in their registers until the mode is written or the dispatch is switched on.
  if (was_started_ && !covers(address, count, mode_)) return;
  if (value(mode_) != kModeSocControl && covers(address, count, mode_)) {
    battery_.stop_dispatch();
    return;
  }
  battery_.start_dispatch(static_cast<double>(value(power_)),
                          static_cast<double>(value(soc_limit_)) / 1e4, value(time_));
}

std::int64_t RegisterImage::value(int point) const {
  std::int64_t result = 0;
  const RegisterPoint& p = map_.points[point];
  static_cast<void>(decode(p, &registers_[p.address], result));
  return result;
}

void RegisterImage::set(int point, std::int64_t value) {
  if (point < 0) return;  // this map does not know it
  const RegisterPoint& p = map_.points[point];
  RegisterBlock block;
  if (encode(p, value, Rounding::kNearest, block) != Status::kOk) return;
  for (int i = 0; i < block.size(); ++i) registers_[p.address + i] = block[i];
}

bool RegisterImage::covers(int address, int count, int point) const {
  const RegisterPoint& p = map_.points[point];
  return address <= p.address && p.address + p.register_count() <= address + count;
}

}  // namespace bess
