// Measurement reader: from last read registers to a BatteryMeasurement. Defines the role of points,
// required plausibility, and whether the device is alive (its values change).
#pragma once

#include <cstdint>

#include "edge/core/base/static_vector.h"
#include "edge/core/base/status.h"
#include "edge/core/control/control_types.h"
#include "edge/device/battery/modbus_link.h"
#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "shared/scaled_clock.h"

namespace bess {

// Alive watch: a stalled counter means frozen values; the map's `alive`.

class HeartbeatCheck {
 public:
  /// `map` must outlive this object.
  explicit HeartbeatCheck(const RegisterMap& map) : map_(map) {}

  /// Must be called after each reading; true also if the map names no counter. `now_ns` is the
  /// device's time.
  bool is_alive(const PointValues& live, std::int64_t now_ns) {
    if (map_.alive.point < 0) return true;
    std::int64_t counter = 0;
    if (!live_value(map_, live, map_.alive.point, counter)) return false;
    if (moved_ns_ == 0 || counter != counter_) moved_ns_ = now_ns;
    counter_ = counter;
    return now_ns - moved_ns_ <= map_.alive.max_age_s * kNanosecondsPerSecond;
  }

 private:
  const RegisterMap& map_;
  std::int64_t moved_ns_ = 0;  ///< last change of the counter; 0 = never read
  std::int64_t counter_ = 0;
};

// Read plan: nearby points are read as one span.

/// Location of a point after unit groups, overrides and model walk.
struct PlacedPoint {
  RegisterSpan place;
  std::int8_t point = -1;
};

using PlacedPoints = StaticVector<PlacedPoint, kPointsMax>;
using ReadPlan = StaticVector<RegisterSpan, kPointsMax>;

inline constexpr int kSpanRegistersMax = 120;

/// Merges points into as few spans as the map's gap and size limits permit, avoiding points that
/// are `missing` in the device. Sorts `points`.
void plan_reads(const RegisterMap& map, PlacedPoints& points, const PlacedPoints& missing,
                ReadPlan& plan);

/// Offset of a point's first register in a span; -1 if not included.
int offset_in(const RegisterSpan& span, const PlacedPoint& point);

std::int32_t clamp_to_int32(std::int64_t value);

class MeasurementReader {
 public:
  /// `map` must outlive this object.
  explicit MeasurementReader(const RegisterMap& map) : map_(map), alive_(map) {}

  /// SoC, power or another required value was not received.
  [[nodiscard]] bool lacks_required_values(const PointValues& live) const;
  /// 1 + index of the first required value that is missing or implausible; 0 = none.
  [[nodiscard]] std::int16_t lost_required_point(const PointValues& live) const;

  /// Fills the measurement; kImplausible if a required value is implausible or the device's counter
  /// has stalled. An unknown protective value is reported in `m`. `now_ns` is the device's time.
  Status translate(const PointValues& live, std::int64_t now_ns, BatteryMeasurement& m);

 private:
  void store(const PointValues& live, int point, std::int64_t wide, BatteryMeasurement& m) const;
  /// Required, and not received or implausible.
  [[nodiscard]] bool is_unknown(const PointValues& live, std::int8_t point) const;
  void read_protective(const PointValues& live, BatteryMeasurement& m) const;
  /// False also while its register is unknown.
  [[nodiscard]] bool is_true(const PointValues& live, const Condition& condition) const;

  const RegisterMap& map_;
  HeartbeatCheck alive_;
};

}  // namespace bess
