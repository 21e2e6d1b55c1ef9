// A battery's readings held against each other: the state of charge must move as the measured power
// explains, and power must flow the way that was ordered. Shows wrong signs and scales whose values
// stay in their ranges. Pure; for recordings, not for the control path (supervision.h judges a
// battery at work).
#pragma once

#include <cstdint>
#include <list>
#include <optional>
#include <vector>

#include "edge/device/battery/step_fit.h"
#include "edge/device/registers/live_points.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

// Steps of power out of a recording: every order that was written, and what the measured power did
// until the next one. What step_fit.h tells delay, ramp and lag from. Left out is what shows no
// whole step: one that began before the last had come, met a limit, or was read too seldom.

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

/// What was read at one time: of each kind the newest value.
struct EnergyReading {
  std::int64_t utc_ns = 0;  ///< of the power
  std::int64_t power_w = 0;
  std::optional<std::int64_t> soc_e4;
  std::optional<std::int64_t> order_w;  ///< of the order in force
  std::int64_t order_age_s = 0;         ///< at least this long
};

class EnergyEvidence {
 public:
  /// `settle_s`: by when power follows an order.
  explicit EnergyEvidence(std::int32_t settle_s) : settle_s_(settle_s) {}

  void add(const EnergyReading& reading);

  /// How many times as far as the measured power explains the state of charge has moved: 1 where
  /// all is right, negative where a sign is wrong. Empty when the SoC has changed less than three
  /// times. `capacity_wh` above 0.
  [[nodiscard]] std::optional<double> soc_per_energy(double capacity_wh) const;
  /// Energy has flowed, and the state of charge has not moved at all.
  [[nodiscard]] bool soc_stands_still(double capacity_wh) const;
  [[nodiscard]] double energy_moved_wh() const { return energy_moved_wh_; }

  enum class Answer { kUnknown, kFollows, kOpposite };
  [[nodiscard]] Answer answer() const;
  /// Measured by ordered power; empty when nothing could be compared.
  [[nodiscard]] std::optional<double> power_per_order() const;

 private:
  void balance(const EnergyReading& reading, double energy_wh);
  void compare(const EnergyReading& reading);

  std::int32_t settle_s_;
  std::int64_t last_utc_ns_ = 0;
  double energy_wh_ = 0;        ///< since the SoC changed last; charging is positive
  double energy_moved_wh_ = 0;  ///< charged and discharged together
  std::optional<std::int64_t> soc_e4_;
  int soc_changes_ = 0;
  double soc_times_energy_ = 0, energy_squared_ = 0;  ///< sums over the changes
  int same_way_ = 0, other_way_ = 0;
  double measured_w_ = 0, ordered_w_ = 0;  ///< sums of sizes
};

}  // namespace bess
