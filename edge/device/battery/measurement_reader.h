// Registers as last read -> BatteryMeasurement: which points mean what to the controller, which of
// them must be plausible, and whether the device still lives (its values change). Nothing
// implausible passes.
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/core/base/status.h"
#include "edge/core/control/control_types.h"
#include "edge/device/battery/modbus_link.h"
#include "edge/device/registers/live_points.h"
#include "edge/device/registers/register_map.h"
#include "shared/scaled_clock.h"

namespace bess {

// A device whose counter stands still shows frozen values as if they were new: the map's `alive`.

class AliveWatch {
 public:
  /// `map` must outlive this object.
  explicit AliveWatch(const RegisterMap& map) : map_(map) {}

  /// To be called after each reading; true as well where the map names no counter. `now_ns` is the
  /// device's time.
  bool is_alive(const LivePoints& live, std::int64_t now_ns) {
    if (map_.alive.point < 0) return true;
    std::int64_t counter = 0;
    if (!live_value(map_, live, map_.alive.point, counter)) return false;
    if (moved_ns_ == 0 || counter != counter_) moved_ns_ = now_ns;
    counter_ = counter;
    return now_ns - moved_ns_ <= map_.alive.max_age_s * kNanosecondsPerSecond;
  }

 private:
  const RegisterMap& map_;
  std::int64_t moved_ns_ = 0;  ///< when the counter last moved; 0 = it was never read
  std::int64_t counter_ = 0;
};

// Which registers to ask for in one request: points that lie close together are read as one span.

/// A point where it really lies: unit and address after unit groups, overrides and model walk.
struct PlacedPoint {
  RegisterSpan place;
  std::int8_t point = -1;
};

using PlacedPoints = StaticVector<PlacedPoint, kPointsMax>;
using ReadPlan = StaticVector<RegisterSpan, kPointsMax>;

inline constexpr int kSpanRegistersMax = 120;

/// Merges points into as few spans as the map's gap and size limits allow, over nothing that is
/// `missing` in the device. Sorts `points`.
void plan_reads(const RegisterMap& map, PlacedPoints& points, const PlacedPoints& missing,
                ReadPlan& plan);

/// Offset of a point's first register in a span; -1 when it does not lie in it.
int offset_in(const RegisterSpan& span, const PlacedPoint& point);

std::int32_t clamp_to_int32(std::int64_t value);

class MeasurementReader {
 public:
  /// `map` must outlive this object.
  explicit MeasurementReader(const RegisterMap& map);

  /// State of charge, power or another value without which there is no measurement did not come.
  [[nodiscard]] bool lacks_essentials(const LivePoints& live) const;
  /// 1 + index of the first of these that did not come or is not plausible; 0 = none.
  [[nodiscard]] std::int16_t lost_essential(const LivePoints& live) const;

  /// Fills what is measured; kImplausible when one required value is not plausible or the device's
  /// counter stands still. A protective value that is not known is reported in `m`. `now_ns` is the
  /// device's time.
  Status translate(const LivePoints& live, std::int64_t now_ns, BatteryMeasurement& m);

 private:
  void store(const LivePoints& live, int point, std::int64_t wide, BatteryMeasurement& m) const;
  /// Required, and not read this time, or not plausible.
  [[nodiscard]] bool is_unknown(const LivePoints& live, std::int8_t point) const;
  void read_protective(const LivePoints& live, BatteryMeasurement& m) const;
  /// False as well while its register is not known.
  [[nodiscard]] bool is_true(const LivePoints& live, const Condition& condition) const;

  const RegisterMap& map_;
  // Points with a meaning for the controller, by name; -1 = not in this map.
  int soc_, capacity_, charge_limit_, discharge_limit_, temperature_min_, temperature_max_;
  AliveWatch alive_;
};

}  // namespace bess
