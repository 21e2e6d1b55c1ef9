// Steps of power out of a recording: every order that was written, and what the measured power did
// until the next one. What step_fit.h tells delay, ramp and lag from. Left out is what shows no
// whole step: one that began before the last had come, met a limit, or was read too seldom.
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "edge/battery/answer_curve.h"
#include "edge/registers/live_points.h"
#include "edge/registers/point_places.h"
#include "edge/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

class RecordedSteps {
 public:
  /// `unit` replaces the map's unit id when it is not negative; latencies are wall time and
  /// `time_scale` makes the recording's of them. `map` must outlive this object.
  RecordedSteps(const RegisterMap& map, std::int32_t unit, std::int32_t time_scale);

  /// Every exchange of a recording, in its order.
  void add(const BusExchange& exchange);

  /// Whole ones so far; they live as long as this object.
  [[nodiscard]] std::vector<const AnswerCurve*> whole() const;
  [[nodiscard]] int orders() const { return orders_; }  ///< that asked for another power

 private:
  [[nodiscard]] std::int32_t band_w(std::int64_t order_w) const;
  void take_order(std::int64_t end_ns);
  void begin_step(std::int64_t order_w);
  void take_reading(std::int64_t begin_ns, std::int64_t end_ns);

  const RegisterMap& map_;
  PointPlaces places_;
  LivePoints live_;
  std::int32_t time_scale_;
  int power_ = -1;                       ///< the last point of those that make the power up
  std::optional<std::int64_t> order_w_;  ///< in force, as far as is known
  std::optional<std::int64_t> power_w_;  ///< newest since then
  std::int64_t order_ns_ = 0;            ///< since when, or when it was written once more at once
  std::int64_t from_w_ = 0;              ///< measured before the step
  int sign_ = 1;
  std::list<AnswerCurve> curves_;
  AnswerCurve* step_ = nullptr;  ///< under way
  int orders_ = 0;
};

}  // namespace bess
