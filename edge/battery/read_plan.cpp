#include "edge/battery/read_plan.h"

#include <algorithm>
#include <tuple>

namespace bess {
namespace {

/// A register that the device does not have lies in this span.
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

}  // namespace bess
