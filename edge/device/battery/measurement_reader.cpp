#include "edge/device/battery/measurement_reader.h"

#include <algorithm>
#include <string_view>
#include <tuple>

namespace bess {

namespace {

/// Point with a role in the controller.
struct PointRole {
  std::string_view name;
  std::int32_t BatteryMeasurement::*member;
};

constexpr PointRole kRoles[] = {{"soc", &BatteryMeasurement::soc_e4},
                                {"capacity", &BatteryMeasurement::capacity_wh},
                                {"charge_power_max", &BatteryMeasurement::charge_w_max},
                                {"discharge_power_max", &BatteryMeasurement::discharge_w_max},
                                {"temperature_min", &BatteryMeasurement::temperature_min_deci_c},
                                {"temperature_max", &BatteryMeasurement::temperature_max_deci_c}};

/// True if the span includes a register that the device lacks.
bool is_refused(const RegisterSpan& span, int end, const PlacedPoints& missing) {
  return std::any_of(missing.begin(), missing.end(), [&](const PlacedPoint& m) {
    return m.place.unit == span.unit && m.place.function == span.function &&
           m.place.address < end && m.place.address + m.place.count > span.address;
  });
}

bool can_extend(const RegisterMap& map, const RegisterSpan& span, const RegisterSpan& next,
                const PlacedPoints& missing) {
  const int end = next.address + next.count;
  return !is_refused(span, end, missing) && span.unit == next.unit &&
         span.function == next.function &&
         next.address - (span.address + span.count) <= map.read_gap_registers_max &&
         end - span.address <= std::min(map.registers_per_read_max, kSpanRegistersMax);
}

}  // namespace

void plan_reads(const RegisterMap& map, PlacedPoints& points, const PlacedPoints& missing,
                ReadPlan& plan) {
  plan.clear();
  std::sort(points.begin(), points.end(), [](const PlacedPoint& a, const PlacedPoint& b) {
    return std::tie(a.place.unit, a.place.function, a.place.address) <
           std::tie(b.place.unit, b.place.function, b.place.address);
  });
  for (const PlacedPoint& point : points) {
    if (!plan.empty() && can_extend(map, plan[plan.size() - 1], point.place, missing)) {
      RegisterSpan& last = plan[plan.size() - 1];
      const int end = point.place.address + point.place.count;
      last.count = static_cast<std::uint16_t>(std::max<int>(last.count, end - last.address));
    } else {
      plan.push_back(point.place);
    }
  }
}

int offset_in(const RegisterSpan& span, const PlacedPoint& point) {
  const int offset = point.place.address - span.address;
  const bool inside = point.place.unit == span.unit && point.place.function == span.function &&
                      offset >= 0 && offset + point.place.count <= span.count;
  return inside ? offset : -1;
}

std::int32_t clamp_to_int32(std::int64_t value) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, INT32_MIN, INT32_MAX));
}

bool MeasurementReader::lacks_required_values(const PointValues& live) const {
  return std::ranges::any_of(map_.required, [&](std::int8_t point) { return live.failed[point]; });
}

bool MeasurementReader::is_unknown(const PointValues& live, std::int8_t point) const {
  std::int64_t value = 0;
  return !live.absent[point] && (live.failed[point] || !live_value(map_, live, point, value));
}

std::int16_t MeasurementReader::lost_required_point(const PointValues& live) const {
  const auto* const lost = std::find_if(map_.required.begin(), map_.required.end(),
                                        [&](std::int8_t point) { return is_unknown(live, point); });
  return lost == map_.required.end() ? 0 : static_cast<std::int16_t>(*lost + 1);
}

void MeasurementReader::read_protective(const PointValues& live, BatteryMeasurement& m) const {
  for (const std::int8_t point : map_.protective) {
    std::int64_t value = 0;
    if (is_unknown(live, point)) {
      if (m.lost_point == 0) m.lost_point = static_cast<std::int16_t>(point + 1);
    } else if (live_value(map_, live, point, value)) {
      store(live, point, value, m);
    }
  }
  m.grid_unknown = map_.off_grid.point >= 0 && is_unknown(live, map_.off_grid.point);
}

Status MeasurementReader::translate(const PointValues& live, std::int64_t now_ns,
                                    BatteryMeasurement& m) {
  for (const std::int8_t point : map_.required) {
    std::int64_t value = 0;
    if (live.absent[point]) continue;
    if (!live_value(map_, live, point, value)) return Status::kImplausible;
    store(live, point, value, m);
  }
  read_protective(live, m);
  std::int64_t power_w = 0;
  if (!live_power(map_, map_.measured_power, live, power_w)) return Status::kImplausible;
  m.power_w = clamp_to_int32(power_w);
  for (const Condition& alarm : map_.alarms) {
    if (is_true(live, alarm)) m.alarm = true;
  }
  for (const Condition& warning : map_.warnings) {
    if (is_true(live, warning)) m.warning = true;
  }
  m.off_grid = map_.off_grid.point >= 0 && is_true(live, map_.off_grid);
  // Most alarms concern the lost grid; the 0 W of an alarm would cut off the house.
  if (m.off_grid && m.alarm) {
    m.alarm = false;
    m.warning = true;
  }
  m.has_grid_power = live_power(map_, map_.grid_power, live.received(), power_w);
  if (m.has_grid_power) m.grid_power_w = clamp_to_int32(power_w);
  return alive_.is_alive(live, now_ns) ? Status::kOk : Status::kImplausible;
}

void MeasurementReader::store(const PointValues& live, int point, std::int64_t wide,
                              BatteryMeasurement& m) const {
  const std::int32_t value = clamp_to_int32(wide);
  Scaling scaling;
  const bool is_beyond = live_scaling(map_, live, point, scaling) &&
                         is_cut(map_.points[point], live.raw[point], scaling);
  if (is_beyond) m.cut_point = static_cast<std::int16_t>(point + 1);
  for (const PointRole& role : kRoles) {
    if (map_.points[point].name == role.name) m.*role.member = value;
  }
}

bool MeasurementReader::is_true(const PointValues& live, const Condition& condition) const {
  std::int64_t value = 0;
  return live_value(map_, live, condition.point, value) && condition.holds(value);
}

}  // namespace bess
